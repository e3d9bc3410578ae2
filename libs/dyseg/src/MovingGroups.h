// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/DysegModel.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Takes back single points that were called moving without company, and groups that stood where
 * they stand.
 *
 * Points are put in a grid seen from above. Cells in which most doubtful points (those with any
 * probability) are called moving, and that are not flat ground, are joined with their neighbours;
 * called points outside such groups, or in groups of fewer than `min_points`, fall to a probability
 * of at most 0.4; so do groups of which an earlier scan saw nearly all at its place and hardly any
 * place free.
 * \param seen one per point, in that earlier scan.
 * \param probability one per point; 0 where nothing was looked at.
 */
void keepMovingGroups(const std::vector<Eigen::Vector3f>& points,
                      const std::vector<SeenBefore>& seen,
                      double cell_size,
                      int min_points,
                      std::vector<float>& probability);
}  // namespace dyslam
