// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/tracking/PolynomialTrajectory.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
struct AdaptiveOptions
{
  double memory = 0.97;           //!< how much an error still counts one sighting later, in (0, 1]
  double regularisation = 1.0;    //!< added to every fit's error variance, times the least of them
  double prior_sigma = 0.15;      //!< expected error of a prediction before any was seen [m]
  double prior_weight = 3;        //!< how many seen errors the prior is worth
  double first_speed_sigma = 5;   //!< of an object seen once [m/s]
  double acceleration_sigma = 3;  //!< doubt of predictions further ahead than usual [m/s^2]
};

/** Predicts an object's next position from a bank of polynomial fits of many degrees and windows,
 * weighted by how well each did on this very object so far.
 *
 * Every fit predicts every sighting before it is seen. The weights minimise the expected squared
 * error of the weighted mean under the fits' discounted error covariance C (a unit-sum,
 * minimum-variance combination, w ~ (C + r I)^-1 1), so a window that lags on a curve or a degree
 * that amplifies noise loses its say within a few frames. Causal; deterministic; the covariance
 * comes from the combination's own past errors.
 *
 * All fits share one QR: rows are added from the newest sighting back, and the triangular factor
 * after k rows holds the fits of every degree for the window k.
 */
class AdaptivePredictor
{
 public:
  struct Fit
  {
    int degree;
    int window;
  };
  /** Degree and window of every member of the bank, windows never falling. */
  [[nodiscard]] static const std::vector<Fit>& bank();

  explicit AdaptivePredictor(const AdaptiveOptions& options = {});

  /** Learn from a sighting. False, and nothing changes, for NaN or a stamp not after the last. */
  bool add(const TimedPosition& sighting);

  [[nodiscard]] MotionPrediction predict(double stamp) const;

  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }
  [[nodiscard]] std::size_t size() const { return history_.size(); }
  /** The weight of every member now; they sum to 1. */
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }

 private:
  void learn(const TimedPosition& sighting);
  void refit();
  void reweigh();
  [[nodiscard]] Eigen::MatrixX2d predictAll(double stamp) const;

  AdaptiveOptions options_;
  std::deque<TimedPosition> history_;
  /** Coefficients of each member: position = origin + sum_k row(6 i + k) * tau^k. */
  Eigen::MatrixX2d coefficients_;
  Eigen::VectorXd slope_leverage_;  //!< variance of each member's velocity per unit noise [1/s^2]
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double time_scale_ = 1;  //!< seconds per unit of tau, which counts back from the newest sighting
  Eigen::MatrixXd error_covariance_;  //!< discounted sum over sightings
  double error_count_ = 0;            //!< discounted
  Eigen::Matrix2d own_errors_ = Eigen::Matrix2d::Zero();
  Eigen::VectorXd weights_;
  Eigen::VectorXd velocity_weights_;
};
}  // namespace dyslam
