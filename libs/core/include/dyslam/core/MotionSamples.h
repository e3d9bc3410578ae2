// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <optional>

namespace dyslam
{
class StateArchive;

/** Measurement of an inertial measurement unit (IMU) at one instant. */
struct ImuSample
{
  double stamp = 0;  //!< UNIX time [s]
  Eigen::Vector3d angular_velocity =
      Eigen::Vector3d::Zero();                  //!< measured by the gyroscopes, IMU frame [rad/s]
  std::optional<Eigen::Vector3d> acceleration;  //!< including gravity, IMU frame [m/s^2]
  Pose T_vehicle_imu = Pose::Identity();

  void exchangeState(StateArchive& archive);
};

/** Measurement of wheel odometry at one instant. */
struct WheelSample
{
  double stamp = 0;          //!< UNIX time [s]
  double forward_speed = 0;  //!< speed of the vehicle frame's origin along its x axis [m/s]
  double yaw_rate = 0;       //!< angular rate about the vehicle's z axis [rad/s]
};
}  // namespace dyslam
