// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <optional>

namespace dyslam
{
class StateArchive;

/** What an inertial measurement unit measured at one instant. */
struct ImuSample
{
  double stamp = 0;  //!< UNIX time [s]
  Eigen::Vector3d angular_velocity =
      Eigen::Vector3d::Zero();                  //!< of the gyroscopes, IMU frame [rad/s]
  std::optional<Eigen::Vector3d> acceleration;  //!< with gravity, IMU frame [m/s^2]
  Pose T_vehicle_imu = Pose::Identity();

  void exchangeState(StateArchive& archive);
};

/** What the wheels of the vehicle measured at one instant. */
struct WheelSample
{
  double stamp = 0;          //!< UNIX time [s]
  double forward_speed = 0;  //!< of the vehicle frame's origin, along its x axis [m/s]
  double yaw_rate = 0;       //!< about the z axis [rad/s]
};
}  // namespace dyslam
