// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/tracking/PolynomialTrajectory.h>

#include <Eigen/Core>
#include <array>
#include <optional>

namespace dyslam
{
struct AdaptiveOptions
{
  double memory = 0.97;           //!< how much an error still counts one sighting later, in (0, 1]
  double regularisation = 1.0;    //!< added to every fit's error variance, times the least of them
  double noise_weight = 3;        //!< sightings that what noise alone does to a fit counts as
  double outlier_sigmas = 3;      //!< farther sightings are drawn in, unless the next agrees
  double least_sigma = 0.03;      //!< of the sigma meant there [m]
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
 * that amplifies noise loses its say within a few frames. While few errors are known, C is drawn to
 * what noise of the sightings alone would do to each fit. A single sighting far off the prediction
 * is drawn in; if the next is far off, too, both are taken as they were. Causal; deterministic; the
 * covariance comes from the combination's own past errors.
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
  static constexpr int members = 21;
  using Weights = Eigen::Matrix<double, members, 1>;
  /** Degree and window of every member of the bank, windows never falling. */
  static constexpr std::array<Fit, members> bank{
      {{1, 3},  {1, 4},  {1, 5},  {2, 5},  {1, 7},  {2, 7},  {1, 10},
       {2, 10}, {1, 15}, {2, 15}, {3, 15}, {2, 20}, {3, 20}, {2, 30},
       {3, 30}, {4, 30}, {3, 40}, {4, 40}, {5, 40}, {4, 50}, {5, 50}}};

  explicit AdaptivePredictor(const AdaptiveOptions& options = {});

  /** Learn from a sighting. False, and nothing changes, for NaN or a stamp not after the last. */
  bool add(const TimedPosition& sighting);

  [[nodiscard]] MotionPrediction predict(double stamp) const;

  /** Move the whole history: what was taken for the centre so far was this far off [m]. */
  void shift(const Eigen::Vector2d& offset);

  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }
  [[nodiscard]] std::size_t size() const { return history_.size(); }
  /** The weight of every member now; they sum to 1. */
  [[nodiscard]] const Weights& weights() const { return weights_; }

  using Positions = Eigen::Matrix<double, members, 2>;
  /** What each member says, extrapolated as it is. The history must not be empty. */
  [[nodiscard]] Positions memberPredictions(double stamp) const;

 private:
  static constexpr int terms = PolynomialTrajectory::max_degree + 1;

  [[nodiscard]] Eigen::Vector2d drawnIn(const TimedPosition& sighting);
  void learn(const TimedPosition& sighting);
  void refit();
  void reweigh();

  AdaptiveOptions options_;
  std::deque<TimedPosition> history_;
  /** Coefficients of each member: position = origin + sum_k row(6 i + k) * tau^k. */
  Eigen::Matrix<double, members * terms, 2> coefficients_;
  Weights slope_leverage_ =
      Weights::Zero();  //!< variance of each member's velocity per unit noise [1/s^2]
  Weights noise_gain_ = Weights::Ones();  //!< variance of each member's next prediction, likewise
  std::optional<Eigen::Vector2d> drawn_from_;  //!< where the last sighting was, if drawn in
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double time_scale_ = 1;  //!< seconds per unit of tau, which counts back from the newest sighting
  Eigen::Matrix<double, members, members> error_covariance_;  //!< discounted sum over sightings
  double error_count_ = 0;                                    //!< discounted
  Eigen::Matrix2d own_errors_ = Eigen::Matrix2d::Zero();
  Weights weights_;
  Weights velocity_weights_;
};
}  // namespace dyslam
