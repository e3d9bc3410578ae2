// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/tracking/PolynomialTrajectory.h>

#include <Eigen/Core>
#include <array>
#include <deque>
#include <optional>

namespace dyslam
{
class StateArchive;

struct AdaptiveOptions
{
  double forgetting_factor = 0.97;  //!< factor on the weight of past errors per observation, (0, 1]
  double regularisation = 1.0;      //!< added to each error variance, as a multiple of the smallest
  double noise_weight = 3;          //!< weight of the noise-only error model, as a number of errors
  double outlier_sigmas = 3;        //!< gate beyond which an observation is clipped [sigma]
  double min_sigma = 0.03;          //!< lower limit of the sigma of the outlier gate [m]
  double prior_sigma = 0.15;        //!< prior standard deviation of a prediction [m]
  double prior_weight = 3;          //!< weight of prior_sigma, as a number of errors
  double initial_speed_sigma = 5;   //!< standard deviation of the speed after one observation [m/s]
  double acceleration_sigma = 3;    //!< sigma of the acceleration beyond the usual interval [m/s^2]
};

/** Predicts an object's next position with an ensemble of polynomial fits of different degrees and
 * window lengths, weighted by their past prediction errors on this object.
 *
 * Each fit predicts each observation before it is added. The weights minimise the expected squared
 * error of the weighted mean under the exponentially discounted error covariance C of the fits
 * (minimum-variance combination with unit sum, w ~ (C + r I)^-1 1). A window that lags on a curve
 * or a degree that amplifies noise therefore loses its weight within a few frames. While few errors
 * are known, C is blended with the error that observation noise alone causes in each fit. A single
 * outlier is clipped to the gate; if the next observation is outside the gate too, both are used
 * unclipped. The covariance is estimated from the past errors of the combination. Causal,
 * deterministic, not thread-safe.
 *
 * All fits share one QR factorisation: rows are added from the newest observation backwards, and
 * the triangular factor after k rows contains the fits of every degree for window k.
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
  /** Degree and window of each member, in ascending order of windows. */
  static constexpr std::array<Fit, members> bank{
      {{1, 3},  {1, 4},  {1, 5},  {2, 5},  {1, 7},  {2, 7},  {1, 10},
       {2, 10}, {1, 15}, {2, 15}, {3, 15}, {2, 20}, {3, 20}, {2, 30},
       {3, 30}, {4, 30}, {3, 40}, {4, 40}, {5, 40}, {4, 50}, {5, 50}}};

  explicit AdaptivePredictor(const AdaptiveOptions& options = {});

  /** Adds an observation and updates the weights. \return false, with nothing changed, for
   * non-finite values or a stamp not after the last one. */
  bool add(const TimedPosition& observation);

  /** Position, velocity and their covariances at `stamp` [s]; not valid without a history. */
  [[nodiscard]] MotionPrediction predict(double stamp) const;

  /** Translates the whole history [m], after the estimate of the object's centre was corrected. */
  void shift(const Eigen::Vector2d& offset);

  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }
  [[nodiscard]] std::size_t size() const { return history_.size(); }
  /** Current weights of the members; they sum to 1. */
  [[nodiscard]] const Weights& weights() const { return weights_; }

  using Positions = Eigen::Matrix<double, members, 2>;
  /** Predicted position of each member [m]. The history must not be empty. */
  [[nodiscard]] Positions memberPredictions(double stamp) const;

  /** Saves or loads the complete state, including the options. */
  void exchangeState(StateArchive& archive);

 private:
  static constexpr int terms = PolynomialTrajectory::max_degree + 1;

  [[nodiscard]] Eigen::Vector2d clipOutlier(const TimedPosition& observation);
  void updateErrorStatistics(const TimedPosition& observation);
  void refit();
  /** \param horizon time since the newest observation [s] \param trained_horizon the part of it for
   * which the weights hold [s] \param usual_interval mean interval of the observations [s] */
  void setCovariances(double horizon,
                      double trained_horizon,
                      double usual_interval,
                      MotionPrediction& prediction) const;
  void updateWeights();

  AdaptiveOptions options_;
  std::deque<TimedPosition> history_;
  /** Coefficients of each member: position = origin + sum_k row(6 i + k) * tau^k. */
  Eigen::Matrix<double, members * terms, 2> coefficients_;
  /** Variance of each member's velocity per unit of observation variance [1/s^2]. */
  Weights velocity_leverage_ = Weights::Zero();
  /** Variance of each member's next prediction per unit of observation variance. */
  Weights noise_gain_ = Weights::Ones();
  std::optional<Eigen::Vector2d> unclipped_position_;  //!< last observation before clipping [m]
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double time_scale_ = 1;  //!< [s] per unit of tau; tau is 0 at the newest observation
  Eigen::Matrix<double, members, members> error_covariance_;  //!< discounted sum of products
  double error_count_ = 0;                                    //!< discounted number of errors
  Eigen::Matrix2d combined_error_covariance_ = Eigen::Matrix2d::Zero();  //!< discounted sum
  Weights weights_;
  Weights velocity_weights_;
};
}  // namespace dyslam
