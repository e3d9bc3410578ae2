// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Measurement time of each point of a revolution, from the order of the points, if they are stored
 * as a spinning sensor fired them: all lasers at one azimuth, then at the next, once around. Many
 * drivers and data sets without point times keep this order (nuScenes, NCLT); scans sorted by ring
 * (KITTI) do not show when they began.
 * \param points lidar frame [m], including points that are no returns
 * \return for each point the fraction of a revolution since the first point, above 1 beyond a full
 * turn; empty if the points are in another order or cover less than three quarters of a turn */
[[nodiscard]] std::vector<float> firingFractions(const std::vector<Eigen::Vector3f>& points);

/** Whether firingFractions() of the points is not empty. */
[[nodiscard]] bool inFiringOrder(const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
