// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Pose.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Ini section `[motion_sensors]`. */
struct MotionSensorOptions : Options
{
  bool gyroscope = true;       //!< use the angular velocities of Frame::imu
  bool wheel_odometry = true;  //!< use the speeds of Frame::wheels
  /** Sigma of the mean angular velocity between two scans [rad/s]. */
  double gyroscope_sigma = 0.005;
  /** Sigma in proportion to the angular velocity: misaligned axes, clocks that differ. */
  double gyroscope_sigma_ratio = 0.02;
  double gyroscope_bias_sigma = 0.01;  //!< sigma of the bias, before it is estimated [rad/s]
  double wheel_sigma = 0.05;           //!< sigma of the mean speed between two scans [m/s]
  double wheel_scale_sigma = 0.03;  //!< sigma of the relative scale error, before it is estimated
  double wheel_gate = 6;            //!< sigmas from the prior beyond which a speed is rejected
  double max_gap = 0.25;            //!< largest time without a sample [s]

  void describe(OptionsVisitor& visitor) override;
};

/** Motion between two scans by gyroscope and wheels. */
struct SensedMotion
{
  /** Motion of the vehicle; components that were not measured are as predicted. */
  Pose T_previous_current = Pose::Identity();
  /** Information of log(T_sensed^-1 T), [translation, rotation]; zero for the components that were
   * not measured. */
  Matrix6 information = Matrix6::Zero();
  /** Rotation by the gyroscope, also where that is not trusted. */
  std::optional<Eigen::Matrix3d> rotation;
  std::optional<double> displacement;  //!< distance forward along the path, by the wheels [m]
};

/** The vehicle's motion by gyroscope and wheel odometry.
 *
 * The samples are integrated, with linear interpolation between them. The gyroscope's bias and the
 * scale of the wheels' speed are estimated from the motions that the scans show. A gyroscope that
 * contradicts these motions on about half of the recent scans is not trusted. Not thread-safe.
 */
class MotionSensors
{
 public:
  /** \throws UserError for options out of range. */
  explicit MotionSensors(const MotionSensorOptions& options);
  ~MotionSensors();
  MotionSensors(MotionSensors&&) noexcept;

  /** Adds the samples of a frame. Left out: those that are not finite, not later than the ones
   * before, more than a second later than the scan, or more than 10 s earlier. */
  void add(const Frame& frame);

  /** \param begin,end stamps of two scans in a row [s]
   * \param T_predicted motion in between by others
   * \return nothing if neither sensor has samples throughout */
  [[nodiscard]] std::optional<SensedMotion> sense(double begin,
                                                  double end,
                                                  const Pose& T_predicted);

  /** Forward speed at an instant [m/s]; nothing without samples there. */
  [[nodiscard]] std::optional<double> speedAt(double stamp) const;

  /** Fuses a sensed motion with a prior. A displacement beyond `wheel_gate` is left out (wheels
   * slip); a rotation far from the prior outweighs it (turns begin suddenly).
   * \return the information that was added */
  [[nodiscard]] Matrix6 fuse(const SensedMotion& sensed, MotionPrior& prior) const;

  /** Compares a sensed motion with the one that was found with the scans; estimates bias and scale.
   * \param fused information of fuse() \param dt between the scans [s]
   * \param measured information of the scans alone */
  void compare(const SensedMotion& sensed,
               const Matrix6& fused,
               double dt,
               const Pose& T_previous_current,
               const Matrix6& measured);

  /** Sensors that were used: " + gyroscope + wheel_odometry", or a part of it. */
  [[nodiscard]] std::string name() const;
  /** Sensors that contradict the scans or do not fit their times, a sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** What is kept from frame to frame. */
  void exchangeState(StateArchive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
