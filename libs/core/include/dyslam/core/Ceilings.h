// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MapGround.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** For each point of a map whether it is part of a ceiling or the like, such as the lower side of a
 * bridge: seen from above these hide the floor. A ceiling is a horizontal layer 2.2 to 12.7 m over
 * the ground: most of the nine cells of 1 m around the point have points at its height, most points
 * over 2.2 m in them are at its height, and there are none right below it. Not so the points of
 * walls, trees and facades.
 * \param points [m], z up; those that are not finite are no ceilings \param ground of these points
 */
[[nodiscard]] std::vector<bool> ceilingPoints(const std::vector<Eigen::Vector3f>& points,
                                              const MapGround& ground);

/** As ceilingPoints(), but none if they are fewer than one point in 200: those are awnings, tree
 * tops and the like, which hide little. */
[[nodiscard]] std::vector<bool> ceilingPointsIfMany(const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
