// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/DysegModel.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
struct MovingGroupsOptions
{
  double cell_size = 0.6;  //!< side of a grid cell [m]
  double reach = 102.4;    //!< half extent of the network's grid [m]
  int min_points = 5;      //!< least number of moving points of a group
};

/** Rejects isolated moving points, and groups that were already at their position.
 *
 * Points are binned in a bird's-eye-view grid. Cells in which most of the candidates (points with a
 * positive probability) are moving, and that are not flat ground, form groups (connected
 * components). The probability is limited to 0.4 for moving points outside groups, in groups of
 * fewer than min_points, and in groups whose positions an earlier scan observed almost all occupied
 * and hardly any free.
 * \param points sensor frame [m]
 * \param visibility visibility of each point's position in that earlier scan
 * \param probability moving probability of each point, filtered in place; 0 for points outside the
 * network's input
 */
void keepMovingGroups(const std::vector<Eigen::Vector3f>& points,
                      const std::vector<PastVisibility>& visibility,
                      const MovingGroupsOptions& options,
                      std::vector<float>& probability);
}  // namespace dyslam
