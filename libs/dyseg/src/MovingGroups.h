// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/DysegModel.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
struct MovingGroupsOptions
{
  double cell_size = 0.6;  //!< m
  double reach = 102.4;    //!< m to each side; farther points were not looked at
  int min_points = 5;      //!< called moving, in the smallest group that counts
};

/** Takes back single points that were called moving without company, and groups that stood where
 * they stand.
 *
 * Points are put in a grid seen from above. Cells in which most doubtful points (those with any
 * probability) are called moving, and that are not flat ground, are joined with their neighbours;
 * called points outside such groups, or in groups too small, fall to a probability
 * of at most 0.4; so do groups of which an earlier scan saw nearly all at its place and hardly any
 * place free.
 * \param seen one per point, in that earlier scan.
 * \param probability one per point; 0 where nothing was looked at.
 */
void keepMovingGroups(const std::vector<Eigen::Vector3f>& points,
                      const std::vector<SeenBefore>& seen,
                      const MovingGroupsOptions& options,
                      std::vector<float>& probability);
}  // namespace dyslam
