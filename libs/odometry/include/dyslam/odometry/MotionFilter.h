// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>

namespace dyslam
{
class StateArchive;

/** Ini section `[motion]`. */
struct MotionFilterOptions : Options
{
  double acceleration_sigma = 3;  //!< sigma of the acceleration [m/s^2]
  /** Sigma of the angular acceleration [rad/s^2]. */
  double angular_acceleration_sigma = 57.3 * radians_per_degree;
  double start_speed_sigma = 20;  //!< sigma of the velocity at the first scan, if not known [m/s]
  /** Sigma of the angular velocity at the first scan [rad/s]. */
  double start_turn_rate_sigma = 57.3 * radians_per_degree;
  void describe(OptionsVisitor& visitor) override;
};

/** A constant-velocity Kalman filter of pose and velocity, with white-noise acceleration.
 *
 * If the scene constrains the motion well, the velocity follows the last motion; if it does not
 * (tunnels, highways between guard rails), the velocity is averaged over several scans by their
 * information. Velocities are twists [translation, rotation] in the vehicle frame, per second;
 * errors are perturbations on the right of a pose.
 */
class MotionFilter
{
 public:
  explicit MotionFilter(const MotionFilterOptions& options);

  /** Restarts with a velocity. \param sigma sigma of the velocity [m/s], [rad/s] */
  void start(const Vector6& velocity, double sigma, double angular_sigma);

  /** Predicted T_previous_current over the next `dt` seconds; the identity for dt <= 0. */
  [[nodiscard]] Pose predict(double dt) const;
  /** Information of log(T_predicted^-1 T) of the predicted pose. */
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
  /** Updates with a motion that counts as exact. */
  void follow(double dt, const Pose& T_previous_current);
  /** To be called after a gap of `dt` seconds without observed motion: keeps the velocity, with the
   * uncertainty caused by the acceleration, but at most that of the first scan. */
  void forget(double dt);
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

 private:
  using Matrix12 = Eigen::Matrix<double, 12, 12>;

  [[nodiscard]] Matrix12 predictedCovariance(double dt) const;

  MotionFilterOptions options_;
  Vector6 velocity_ = Vector6::Zero();      //!< velocity at the last scan [m/s, rad/s]
  Matrix12 covariance_ = Matrix12::Zero();  //!< covariance of pose and velocity at the last scan
};
}  // namespace dyslam
