// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** What the cleaning of a map has removed.
 * \param all points of the map without cleaning \return those in no voxel of the cleaned map */
[[nodiscard]] std::vector<Eigen::Vector3f> removedPoints(const MapPoints& all,
                                                         const StaticMap& cleaned);
}  // namespace dyslam
