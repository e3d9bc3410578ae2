// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/RigidFlow.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Per cell, probabilities of the offsets in a window around the predicted position, row by row. */
struct OffsetWindows
{
  const float* probability = nullptr;             //!< N x (2 radius + 1)^2
  int radius = 0;                                 //!< radius of the windows [cells]
  float cell_size = 0;                            //!< side of a cell [m]
  const std::vector<Eigen::Vector2f>& positions;  //!< N cell centres [m]
  const std::vector<float>& weights;              //!< N weights of the cells, >= 0
};

struct MotionSearchResult
{
  PlanarMotion motion;
  /** Relative margin of the motion's score over the score of any motion of the same yaw that is
   * more than one cell away; near 0 if the translation is ambiguous. */
  double margin = 1;
};

/** Maximum-likelihood planar motion over a grid of translations and yaws, with subcell refinement.
 *
 * Unlike a fit to each window's peak, it handles cells with an ambiguous direction (guard rails),
 * and the influence of moving objects is bounded. If no cell has enough weight, the result is the
 * centre.
 *
 * \param centre motion at the windows' centres \param yaw_step step between the yaws of the grid
 * [rad] \param yaw_steps number of yaw steps to each side of the centre's yaw
 */
[[nodiscard]] MotionSearchResult searchMotion(const OffsetWindows& windows,
                                              const PlanarMotion& centre,
                                              double yaw_step,
                                              int yaw_steps);
}  // namespace dyslam
