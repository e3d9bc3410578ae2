// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Labels.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** A `.label` file: little-endian uint32 per point. \throws UserError. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path);
/** \param expected the number of points of the scan. \throws UserError if the file has another. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path, std::size_t expected);
void writeLabels(const std::string& path, const std::vector<Label>& labels);

/** Folder of the label files of a run, a recording or its ground truth: `labels` in its folder if
 * that has any, else the folder itself; nothing if that has none either.
 * \throws UserError if a folder cannot be read. */
[[nodiscard]] std::optional<std::string> labelFolderOf(const std::string& folder);
}  // namespace dyslam
