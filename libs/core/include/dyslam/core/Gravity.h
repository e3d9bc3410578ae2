// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace dyslam
{
/** The vertical in the map frame, from the accelerations of an IMU. */
struct Gravity
{
  /** Unit vector away from the earth, map frame; its z axis if the map was levelled. */
  Eigen::Vector3d up_map = Eigen::Vector3d::UnitZ();
  /** Angle between the vertical and the map's z axis, before it was levelled [rad]. */
  double tilt = 0;
  double tilt_sigma = 0;  //!< standard deviation of the vertical's direction [rad]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  //!< of the accelerometer, vehicle axes [m/s^2]
  std::size_t directions = 0;                      //!< number of measured directions
  double rmse = 0;        //!< RMSE of the measured directions against the trajectory [rad]
  bool fused = false;     //!< the graph was optimised with the directions
  bool levelled = false;  //!< the map was rotated so that its z axis is vertical
};
}  // namespace dyslam
