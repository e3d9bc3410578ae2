// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Indices of the points in a box that is enlarged by 0.1 m on all sides but the bottom, and
 * without its lowest 0.1 m (ground). \param box, points in the same frame */
[[nodiscard]] std::vector<std::uint32_t> pointsInside(const Box& box,
                                                      const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
