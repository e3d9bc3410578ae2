// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

namespace dyslam
{
class StateArchive;

/** An observed position of an object's centre. */
struct TimedPosition
{
  double stamp = 0;                                    //!< time of the observation [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  //!< x, y in a fixed frame [m]
};

/** Position and velocity of a fitted motion at one time, in the frame of the observations. */
struct MotionPrediction
{
  bool valid = false;                                  //!< false without a history
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  //!< x, y [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  //!< derivative of the fit (Eq. 5) [m/s]
  /** Covariance of a new observation about `position` [m^2]: that of the fit plus that of one
   * observation. */
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Identity();  //!< of `velocity` [m^2/s^2]
  int degree = 0;           //!< degree of the fit; lower than configured for a short history
  std::size_t samples = 0;  //!< number of observations in the fit
};

enum class MotionModel
{
  polynomial,        //!< least squares over the window (Eqs. 2-4)
  constant_velocity  //!< line through the last two observations
};

struct PolynomialOptions
{
  MotionModel model = MotionModel::polynomial;
  int degree = 2;                  //!< 0 to 5
  int window = 30;                 //!< number of observations kept (K), at least 1
  double prior_sigma = 0.15;       //!< prior standard deviation of one observation [m]
  double prior_weight = 2;         //!< weight of prior_sigma, in degrees of freedom
  double initial_speed_sigma = 5;  //!< standard deviation of the speed after one observation [m/s]
  double acceleration_sigma = 3;   //!< sigma of the acceleration, for exact fits [m/s^2]
};

/** Polynomials x(t), y(t) fitted to the last K observations of one object (the paper's Eqs. 2-5).
 *
 * Least squares by QR, on time centred and scaled to [-1, 1]. The degree is limited to the number
 * of observations less one. Gaps in time are allowed; stamps must increase (other observations are
 * rejected). Not thread-safe.
 */
class PolynomialTrajectory
{
 public:
  static constexpr int max_degree = 5;
  /** \throws std::invalid_argument for a degree or window out of range. */
  explicit PolynomialTrajectory(const PolynomialOptions& options);

  /** Adds an observation. \return false, with nothing changed, for non-finite values or a stamp not
   * after the last one. */
  bool add(const TimedPosition& observation);
  /** Translates the whole history [m], after the estimate of the object's centre was corrected. */
  void shift(const Eigen::Vector2d& offset);

  /** Evaluates the fit at `stamp` [s], usually after the last observation. */
  [[nodiscard]] MotionPrediction predict(double stamp) const;

  [[nodiscard]] std::size_t size() const { return history_.size(); }
  /** As many observations as the window has. */
  [[nodiscard]] bool full() const;
  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }

  /** Saves or loads the complete state, including the options. */
  void exchangeState(StateArchive& archive);

 private:
  PolynomialOptions options_;
  std::deque<TimedPosition> history_;
};
}  // namespace dyslam
