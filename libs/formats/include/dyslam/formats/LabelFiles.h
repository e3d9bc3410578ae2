// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Labels.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** A `.label` file: little-endian uint32 per point. \throws UserError. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path);
/** \param expected the number of points of the scan. \throws UserError if the file has another. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path, std::size_t expected);
void writeLabels(const std::string& path, const std::vector<Label>& labels);

/** One of the label files in the `labels` of a folder, or else in the folder itself; empty if there
 * is none. */
[[nodiscard]] std::string anyLabelFile(const std::string& folder);
}  // namespace dyslam
