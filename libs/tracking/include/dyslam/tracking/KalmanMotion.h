// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/tracking/PolynomialTrajectory.h>

#include <Eigen/Core>
#include <deque>

namespace dyslam
{
class StateArchive;

struct KalmanOptions
{
  double speed_sigma = 8;    //!< standard deviation of the speed before the first observation [m/s]
  double velocity_walk = 2;  //!< random walk of the velocity [m/s per square root of a second]
};

/** Kalman filter of position and velocity in the plane with a random walk of the velocity, for
 * observations with known covariances. Not thread-safe. */
class KalmanMotion
{
 public:
  explicit KalmanMotion(const KalmanOptions& options = {});

  /** \param covariance of the observed position [m^2] \return false, with nothing changed, for
   * non-finite values or a stamp not after the last one. */
  bool add(const TimedPosition& observation, const Eigen::Matrix2d& covariance);
  /** Prediction at `stamp` [s], not before the last observation. Its covariance is that of a new
   * observation with the noise of the last one. */
  [[nodiscard]] MotionPrediction predict(double stamp) const;
  /** Covariance of the estimated position after the last observation [m^2]. */
  [[nodiscard]] Eigen::Matrix2d positionCovariance() const;
  /** Translates estimate and history [m], after the estimate of the object's centre was corrected.
   */
  void shift(const Eigen::Vector2d& offset);

  /** The last observations, for SignificantMotion and NoiseScale. */
  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }

  /** Saves or loads the complete state, including the options. */
  void exchangeState(StateArchive& archive);

 private:
  void propagate(double dt, Eigen::Vector4d& state, Eigen::Matrix4d& covariance) const;

  KalmanOptions options_;
  std::deque<TimedPosition> history_;
  Eigen::Vector4d state_ = Eigen::Vector4d::Zero();  //!< x, y [m], velocities of x, y [m/s]
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Identity();
  Eigen::Matrix2d noise_ = Eigen::Matrix2d::Identity();  //!< covariance of the last observation
};
}  // namespace dyslam
