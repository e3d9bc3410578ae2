// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Points that the visibility clean-up of a map has removed, map frame [m]. \param all points of
 * the map without cleaning \return the points of `all` in no voxel of the cleaned map */
[[nodiscard]] std::vector<Eigen::Vector3f> removedPoints(const MapPoints& all,
                                                         const StaticMap& cleaned);
}  // namespace dyslam
