// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** An object's position in the plane of the map at a time. */
struct PlanarObservation
{
  double time = 0;                                     //!< Frame::time() [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  //!< x, y in the map frame [m]
  double sigma = 0;                                    //!< sigma of each coordinate [m]
};

/** A velocity with its standard deviation. */
struct SpeedEstimate
{
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  //!< map frame [m/s]
  double sigma = 0;                                    //!< sigma of each coordinate [m/s]
  /** Bounds of the speed at two sigmas [m/s]. */
  [[nodiscard]] double atLeast() const { return velocity.norm() - 2 * sigma; }
  [[nodiscard]] double atMost() const { return velocity.norm() + 2 * sigma; }
};

/** Velocity of the straight line through the observations (least squares); its sigma follows from
 * that of the observations or from their scatter about the line, whichever is larger.
 * \pre at least three observations at different times. */
[[nodiscard]] SpeedEstimate fitSpeed(const std::vector<PlanarObservation>& observations);
}  // namespace dyslam
