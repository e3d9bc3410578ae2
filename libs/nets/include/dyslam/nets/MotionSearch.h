// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/RigidFlow.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Where one cell's content may have gone: probabilities of a window of offsets, row by row. */
struct OffsetWindows
{
  const float* probability = nullptr;          //!< N x (2 radius + 1)^2
  int radius = 0;                              //!< [cells]
  float cell_size = 0;                         //!< [m]
  const std::vector<Eigen::Vector2f>& places;  //!< N centres of the cells [m]
  const std::vector<float>& trust;             //!< N, >= 0
};

struct MotionVote
{
  PlanarMotion motion;
  /** By how much of its score it is ahead of any motion a cell and more away, of the same turn:
   * near 0 where two motions explain about the same. */
  double lead = 1;
};

/** The planar motion that most trusted cells' windows speak for: maximum likelihood over a grid of
 * translations and some yaws, refined between its nodes.
 *
 * Unlike a fit to each window's peak, cells that leave a direction open (guard rails) take no side
 * in it, and what moves otherwise costs a bounded amount.
 *
 * \param centre motion that the windows lie around \param yaw_step between the yaws tried, to both
 * sides of the centre's \param yaw_steps to each side.
 */
[[nodiscard]] MotionVote voteMotion(const OffsetWindows& windows,
                                    const PlanarMotion& centre,
                                    double yaw_step,
                                    int yaw_steps);
}  // namespace dyslam
