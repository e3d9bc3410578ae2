// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Pose.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Unit of the angular velocities of a recording. */
enum class GyroscopeUnit
{
  rad_s,
  deg_s,
};

/** Ini section `[motion_sensors]`. */
struct MotionSensorOptions : Options
{
  bool gyroscope = true;  //!< use the angular velocities of Frame::imu
  GyroscopeUnit gyroscope_unit = GyroscopeUnit::rad_s;  //!< unit of the angular velocities
  /** Use the gyroscope only once its rotations were those of the scans. */
  bool gyroscope_check = true;
  bool wheel_odometry = true;  //!< use the speeds of Frame::wheels
  /** Sigma of the mean angular velocity between two scans [rad/s]. */
  double gyroscope_sigma = 0.286 * radians_per_degree;
  /** Error in proportion to the angular velocity: misaligned axes, clocks that differ. */
  double gyroscope_sigma_ratio = 0.02;
  /** Sigma of the bias, before it is estimated [rad/s]. */
  double gyroscope_bias_sigma = 0.573 * radians_per_degree;
  double wheel_sigma = 0.05;        //!< sigma of the mean speed between two scans [m/s]
  double wheel_scale_sigma = 0.03;  //!< sigma of the relative scale error, before it is estimated
  double wheel_gate = 6;            //!< sigmas from the prior beyond which a speed is rejected
  double max_gap = 0.25;            //!< largest time without a sample [s]

  void describe(OptionsVisitor& visitor) override;
};

/** Motion between two scans measured by gyroscope and wheels. */
struct SensedMotion
{
  /** Measured motion; components that were not measured are predicted. */
  Pose T_previous_current = Pose::Identity();
  /** Information of log(T_sensed^-1 T); zero for components that were not measured. */
  Matrix6 information = Matrix6::Zero();
  std::optional<Eigen::Matrix3d> rotation;  //!< by the gyroscope, even if it is not used
  Eigen::Vector3d mean_rate = Eigen::Vector3d::Zero();  //!< that of `rotation`, with bias [rad/s]
  std::optional<double> displacement;  //!< forward, along the path, by the wheels [m]
};

/** The vehicle's motion by gyroscope and wheel odometry.
 *
 * The samples are integrated, with linear interpolation between them. The gyroscope's bias and the
 * scale of the wheels' speed are estimated by comparison with the motions from the scans. The
 * gyroscope is used once its rotations were those of the scans while the vehicle turned, and not
 * any more while it contradicts them on about half of the recent scans, nor if its angular
 * velocities turn out to be in deg/s. Not thread-safe.
 */
class MotionSensors
{
 public:
  /** \throws UserError for options out of range. */
  explicit MotionSensors(const MotionSensorOptions& options);
  ~MotionSensors();
  MotionSensors(MotionSensors&&) noexcept;

  /** Adds the samples of a frame. Ignores samples that are not finite or impossibly large (10^4
   * rad/s, 10^5 m/s), not later than the previous ones, more than a second later than the scan, or
   * more than 10 s earlier. */
  void add(const Frame& frame);

  /** Motion between two scans. \param begin,end stamps of two successive scans [s]
   * \param T_predicted predicted motion between them, for components that are not measured
   * \return nothing if neither sensor has samples throughout */
  [[nodiscard]] std::optional<SensedMotion> sense(double begin,
                                                  double end,
                                                  const Pose& T_predicted);

  /** The motion with the gyroscope where sense() has left it out, and without where it was used,
   * for a scan that cannot be registered otherwise; nothing without samples of it, or if they are
   * known to be wrong. */
  [[nodiscard]] std::optional<SensedMotion> senseOtherwise(double begin,
                                                           double end,
                                                           const Pose& T_predicted) const;

  /** Forward speed at an instant [m/s]; nothing without samples there. */
  [[nodiscard]] std::optional<double> speedAt(double stamp) const;

  /** Fuses a sensed motion with a prior. A displacement beyond `wheel_gate` is ignored (wheels
   * slip); a rotation far from the prior outweighs the prior (turns begin suddenly).
   * \return the information that was added */
  [[nodiscard]] Matrix6 fuse(const SensedMotion& sensed, MotionPrior& prior) const;

  /** Compares a sensed motion with the motion estimated with the scans; estimates bias and scale.
   * \param fused result of fuse() \param dt time between the scans [s]
   * \param measured information by the scans, without priors */
  void compare(const SensedMotion& sensed,
               const Matrix6& fused,
               double dt,
               const Pose& T_previous_current,
               const Matrix6& measured);

  /** Compares a rotation that the scans show with the gyroscope's at earlier and later times, for a
   * warning. \param begin,end stamps of two successive scans [s] */
  void compareClocks(double begin, double end, const Pose& T_previous_current);

  /** Names of the sensors that were used: " + gyroscope + wheel_odometry", or a part of it. */
  [[nodiscard]] std::string name() const;
  /** Warnings about sensors that contradict the scans or their times, or whose clock differs, one
   * sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
