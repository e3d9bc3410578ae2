// SPDX-License-Identifier: BSD-3-Clause
#include "MotionSampler.h"

#include <cmath>

namespace dyslam::sim
{
namespace
{
constexpr double kImuRate = 100, kWheelRate = 50;  // as common with MEMS units and cars' ABS [Hz]
constexpr double kGravity = 9.81;                  // [m/s^2]

// Standard deviations: white noise of a sample, and errors that are constant in a recording. The
// IMU's values are typical of uncalibrated consumer MEMS units.
constexpr double kGyroscopeNoise = 0.002, kGyroscopeBias = 0.005;       // per axis [rad/s]
constexpr double kAccelerometerNoise = 0.05, kAccelerometerBias = 0.1;  // per axis [m/s^2]
constexpr double kWheelScale = 0.01;  // relative error of the tyre radius (wear, load, pressure)
constexpr double kWheelSpeedNoise = 0.02;    // resolution of the encoders, and slip [m/s]
constexpr double kWheelYawRateNoise = 0.01;  // from the difference of left and right wheels [rad/s]

struct BodyRates
{
  Eigen::Vector3d angular_velocity;  // vehicle frame [rad/s]
  Eigen::Vector3d velocity;          // velocity of the vehicle's origin, vehicle frame [m/s]
};

/** Rates at `t` seconds after the stamp: differences over one step, so that the mean rates of the
 * steps are interpolated and add up to the true motion. */
BodyRates ratesAt(const MotionBetweenScans& motion, double t)
{
  const Pose before = motion.vehicleAt(t - 0.5 * motion.step),
             after = motion.vehicleAt(t + 0.5 * motion.step);
  const Eigen::Matrix3d R_vehicle_map = motion.vehicleAt(t).linear().transpose();
  return {logSO3(before.linear().transpose() * after.linear()) / motion.step,
          R_vehicle_map * (after.translation() - before.translation()) / motion.step};
}

/** Acceleration with gravity as an accelerometer measures it: upwards at rest; vehicle frame
 * [m/s^2].
 *
 * Differences over two steps: a mean over 0.1 s that passes body motion of 2 Hz by 97 %, without
 * the jumps of velocity between steps. */
Eigen::Vector3d specificForceAt(const MotionBetweenScans& motion, double t)
{
  const double span = 2 * motion.step;
  const Pose now = motion.vehicleAt(t);
  const Eigen::Vector3d acceleration =
      (motion.vehicleAt(t - span).translation() - 2 * now.translation() +
       motion.vehicleAt(t + span).translation()) /
      (span * span);
  return now.linear().transpose() * (acceleration + kGravity * Eigen::Vector3d::UnitZ());
}

Eigen::Vector3d gaussianVector(Rng& rng, double sigma)
{
  Eigen::Vector3d v;
  for (double& component : v)
  {
    component = sigma * rng.gaussian();
  }
  return v;
}

/** Samples at `rate` [Hz], the last one at the next stamp. \param fill takes a sample and its time
 * after the stamp [s] */
template <typename Sample, typename Fill>
std::vector<Sample> sampled(const MotionBetweenScans& motion, double rate, const Fill& fill)
{
  const double span = motion.next_stamp - motion.stamp;
  std::vector<Sample> samples(static_cast<std::size_t>(std::lround(span * rate)));
  const auto count = static_cast<double>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const double after = span * static_cast<double>(i + 1) / count;
    samples[i].stamp = motion.stamp + after;
    fill(samples[i], after);
  }
  return samples;
}
}  // namespace

MotionSampler::MotionSampler(const SimulatorOptions& options)
    : noise_(options.noise),
      imu_rng_(combine(options.trafficSeed(), 0x1A0)),
      wheel_rng_(combine(options.trafficSeed(), 0x4EE1))
{
  if (noise_)
  {
    gyroscope_bias_ = gaussianVector(imu_rng_, kGyroscopeBias);
    accelerometer_bias_ = gaussianVector(imu_rng_, kAccelerometerBias);
    wheel_scale_ = 1 + kWheelScale * wheel_rng_.gaussian();
  }
}

std::vector<ImuSample> MotionSampler::imu(const MotionBetweenScans& motion)
{
  return sampled<ImuSample>(
      motion, kImuRate,
      [&](ImuSample& sample, double t)
      {
        sample.angular_velocity = ratesAt(motion, t).angular_velocity;
        sample.acceleration = specificForceAt(motion, t);
        if (noise_)
        {
          sample.angular_velocity += gyroscope_bias_ + gaussianVector(imu_rng_, kGyroscopeNoise);
          *sample.acceleration +=
              accelerometer_bias_ + gaussianVector(imu_rng_, kAccelerometerNoise);
        }
      });
}

std::vector<WheelSample> MotionSampler::wheels(const MotionBetweenScans& motion)
{
  return sampled<WheelSample>(motion, kWheelRate,
                              [&](WheelSample& sample, double t)
                              {
                                const BodyRates rates = ratesAt(motion, t);
                                sample.forward_speed = rates.velocity.x();
                                sample.yaw_rate = rates.angular_velocity.z();
                                if (noise_)
                                {
                                  sample.forward_speed *= wheel_scale_;
                                  sample.forward_speed += kWheelSpeedNoise * wheel_rng_.gaussian();
                                  sample.yaw_rate += kWheelYawRateNoise * wheel_rng_.gaussian();
                                }
                              });
}
}  // namespace dyslam::sim
