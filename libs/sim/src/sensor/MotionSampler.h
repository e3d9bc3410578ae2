// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionSamples.h>
#include <dyslam/sim/SimulatorOptions.h>

#include <functional>
#include <vector>

#include "Random.h"

namespace dyslam::sim
{
/** True motion of the vehicle from one scan's stamp to the next. */
struct MotionBetweenScans
{
  double stamp = 0, next_stamp = 0;  //!< UNIX time [s]
  /** T_map_vehicle at seconds after `stamp`, from two steps before it to two after next_stamp. */
  std::function<Pose(double)> vehicleAt;
  double step = 0;  //!< time between the poses that vehicleAt interpolates [s]
};

/** Simulates an IMU at the origin of the vehicle frame, with its axes, and wheel encoders.
 *
 * Noise is drawn from the traffic seed, by a random stream for each of the two: neither has an
 * influence on the other or on scans.
 */
class MotionSampler
{
 public:
  explicit MotionSampler(const SimulatorOptions& options);

  /** IMU samples at 100 Hz after `stamp` up to `next_stamp`, at which the last one is taken. To be
   * called once for each scan, in order, because the noise continues. */
  [[nodiscard]] std::vector<ImuSample> imu(const MotionBetweenScans& motion);
  /** Wheel samples at 50 Hz, otherwise as imu(). */
  [[nodiscard]] std::vector<WheelSample> wheels(const MotionBetweenScans& motion);

 private:
  bool noise_;
  Rng imu_rng_, wheel_rng_;
  Eigen::Vector3d gyroscope_bias_ = Eigen::Vector3d::Zero();      // [rad/s]
  Eigen::Vector3d accelerometer_bias_ = Eigen::Vector3d::Zero();  // [m/s^2]
  double wheel_scale_ = 1;  // measured speed divided by the true one
};
}  // namespace dyslam::sim
