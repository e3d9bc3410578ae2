// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Points of a .bin file (float32 x y z intensity); those that are no returns stay, as NaN.
 * \throws UserError. */
[[nodiscard]] std::vector<Eigen::Vector3f> readBinPoints(const std::string& path);

/** SemanticKITTI labels of a scan: class in the lower 16 bits, instance in the upper ones.
 * \throws UserError if there is not one per point. */
[[nodiscard]] std::vector<std::uint32_t> readLabels(const std::string& path, std::size_t points);

/** Poses of a text file of 12 numbers a line (3x4, row-major); blank lines are passed over.
 * \throws UserError naming the line that is something else. */
[[nodiscard]] std::vector<Pose> readPoses12(const std::string& path);

/** Scans of a folder whose names end in .bin, sorted. \throws UserError if there is none. */
[[nodiscard]] std::vector<std::string> binFiles(const std::string& folder);
}  // namespace dyslam
