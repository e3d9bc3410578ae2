// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>

namespace dyslam
{
class StateArchive;

/** Ini section `[motion]`. */
struct MotionFilterOptions : Options
{
  double acceleration = 3;          //!< sigma of the acceleration [m/s^2]
  double angular_acceleration = 1;  //!< sigma of the angular acceleration [rad/s^2]
  double start_speed_sigma = 20;    //!< sigma of the velocity at the first scan, if not known [m/s]
  double start_turn_rate_sigma = 1;  //!< sigma of the angular velocity at the first scan [rad/s]
  void describe(OptionsVisitor& visitor) override;
};

/** A constant-velocity Kalman filter of pose and velocity, with white-noise acceleration.
 *
 * Where the scene constrains the motion well, the velocity is that of the last motion; where it
 * does not (tunnels, highways between guard rails), the velocity is averaged over several scans, by
 * their information. Velocities are twists [translation, rotation] in the vehicle frame, per
 * second; errors are perturbations on the right of a pose.
 */
class MotionFilter
{
 public:
  explicit MotionFilter(const MotionFilterOptions& options);

  /** Restart. \param sigma of the velocity: m/s, and rad/s for the rotation. */
  void start(const Vector6& velocity, double sigma, double angular_sigma);

  /** T_previous_current of the next `dt` seconds; none for dt <= 0. */
  [[nodiscard]] Pose predict(double dt) const;
  /** Information of the predicted pose, of log(T_predicted^-1 T). */
  [[nodiscard]] Matrix6 information(double dt) const;

  /** Standard deviation of the predicted position, along its worst direction [m]. */
  [[nodiscard]] double sigma(double dt) const;

  /** Update with a motion that was estimated with the prediction as a prior.
   * \param measured information of the measurement alone, without the prior; zero for none
   * \param prior_weight robust weight of each component of the prediction, in (0, 1] */
  void update(double dt,
              const Pose& T_previous_current,
              const Matrix6& measured,
              const Vector6& prior_weight = Vector6::Ones());
  /** Update with a motion that is taken as exact. */
  void follow(double dt, const Pose& T_previous_current);
  /** After a gap of `dt` seconds, over which the motion was not observed: the same velocity, as
   * uncertain as the acceleration makes it, at most as at the first scan. */
  void forget(double dt);
  /** What is kept from frame to frame. */
  void exchangeState(StateArchive& archive);

 private:
  using Matrix12 = Eigen::Matrix<double, 12, 12>;

  [[nodiscard]] Matrix12 predictedCovariance(double dt) const;

  MotionFilterOptions options_;
  Vector6 velocity_ = Vector6::Zero();      //!< velocity at the last scan [m/s, rad/s]
  Matrix12 covariance_ = Matrix12::Zero();  //!< covariance of pose and velocity at the last scan
};
}  // namespace dyslam
