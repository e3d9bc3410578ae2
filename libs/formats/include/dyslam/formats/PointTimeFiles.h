// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** Folder beside the scans of KITTI's layout, which has none of the kind, with a file of point
 * times for each scan that was not deskewed: of 000000.bin `point_times/000000.time`. */
constexpr const char* point_time_folder = "point_times";

/** Reads a `.time` file: a little-endian float32 per point, the time of its measurement after the
 * stamp of the scan [s], NaN if unknown. \param expected number of points \throws UserError, also
 * for another number. */
[[nodiscard]] std::vector<float> readPointTimes(const std::string& path, std::size_t expected);
void writePointTimes(const std::string& path, const std::vector<float>& times);
}  // namespace dyslam
