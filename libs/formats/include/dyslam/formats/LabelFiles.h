// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Labels.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Reads a `.label` file: a little-endian uint32 per point. \throws UserError. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path);
/** Reads a `.label` file. \param expected number of labels \throws UserError for another number. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path, std::size_t expected);
void writeLabels(const std::string& path, const std::vector<Label>& labels);

/** Folder of the label files of a run, a recording or its ground truth: its subfolder `labels` if
 * that has label files, else the folder itself; nothing if neither has any.
 * \throws UserError if a folder cannot be read. */
[[nodiscard]] std::optional<std::string> labelFolderOf(const std::string& folder);
}  // namespace dyslam
