// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Red, green and blue of a distance: blue at 0 m, over green and yellow, to red at `largest` [m]
 * and beyond; grey for NaN. */
[[nodiscard]] std::array<std::uint8_t, 3> colourOfDistance(float distance, float largest = 0.5F);

/** A binary PLY of the points, coloured by colourOfDistance(), with their distances as the scalar
 * field `scalar_distance`, which CloudCompare shows as "distance".
 * \throws std::invalid_argument unless there is a distance for each point. */
[[nodiscard]] std::string distancePly(const std::vector<Eigen::Vector3f>& points,
                                      const std::vector<float>& distances);
}  // namespace dyslam
