// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dyslam
{
/** Reads the points of a .bin file [m]; all coordinates of points that are no returns become
 * `no_return` (0 or NaN). \throws UserError. */
[[nodiscard]] std::vector<Eigen::Vector3f> readTrainingPoints(const std::string& path,
                                                              float no_return);
}  // namespace dyslam
