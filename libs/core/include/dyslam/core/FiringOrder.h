// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** When each point of a revolution was measured, from the order of the points, where they are
 * stored as a spinning sensor fired them: all lasers of one azimuth, then of the next, once around.
 * Many drivers and data sets without times of points keep this order (nuScenes, NCLT); scans sorted
 * by ring (KITTI) do not show when they began.
 * \param points lidar frame [m], also those that are no returns
 * \return of each point the share of the revolution since the first one, above 1 beyond a full
 * turn; empty if the points are in another order or cover less than three quarters of a turn */
[[nodiscard]] std::vector<float> firingFractions(const std::vector<Eigen::Vector3f>& points);

/** Whether firingFractions() are known. */
[[nodiscard]] bool inFiringOrder(const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
