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

/** Kalman filter of position and velocity in the plane under a random walk of the velocity, for
 * observations whose covariances are known. Not thread-safe. */
class KalmanMotion
{
 public:
  explicit KalmanMotion(const KalmanOptions& options = {});

  /** \param covariance of the position [m^2]. \return false, with nothing changed, for non-finite
   * values or a stamp not after the last one. */
  bool add(const TimedPosition& observation, const Eigen::Matrix2d& covariance);
  /** At `stamp` [s], not before the last observation. The covariance is that of an observation as
   * noisy as the last one. */
  [[nodiscard]] MotionPrediction predict(double stamp) const;
  /** Of the estimate right after the last observation [m^2]. */
  [[nodiscard]] Eigen::Matrix2d positionCovariance() const;
  /** Translates estimate and history [m], after the estimate of the object's centre was corrected.
   */
  void shift(const Eigen::Vector2d& offset);

  /** The last observations. */
  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }

  /** The complete state, options included. */
  void exchangeState(StateArchive& archive);

 private:
  void propagate(double dt, Eigen::Vector4d& state, Eigen::Matrix4d& covariance) const;

  KalmanOptions options_;
  std::deque<TimedPosition> history_;
  Eigen::Vector4d state_ = Eigen::Vector4d::Zero();  //!< x, y, their velocities
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Identity();
  Eigen::Matrix2d noise_ = Eigen::Matrix2d::Identity();  //!< of the last observation
};
}  // namespace dyslam
