// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Positions of the points in a box that is 0.1 m larger on all sides but the bottom; the lowest
 * 0.1 m of it are the ground. \param box, points in the same frame */
[[nodiscard]] std::vector<std::uint32_t> pointsInside(const Box& box,
                                                      const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
