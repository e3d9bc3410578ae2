// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/tracking/AdaptivePredictor.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr int terms = PolynomialTrajectory::max_degree + 1;
/** Triangular factor of the rows [1, tau, ..., tau^5 | x, y]. */
using Factor = Eigen::Matrix<double, terms, terms + 2, Eigen::RowMajor>;
using Equation = Eigen::Matrix<double, 1, terms + 2, Eigen::RowMajor>;

/** Adds one row to the triangular factor by Givens rotations. */
void addRow(Factor& factor, Equation row)
{
  for (int k = 0; k < terms; ++k)
  {
    if (row[k] == 0)
    {
      continue;
    }
    const double diagonal = factor(k, k);
    const double length = std::hypot(diagonal, row[k]);
    const double c = diagonal / length;
    const double s = row[k] / length;
    for (int j = k; j < terms + 2; ++j)
    {
      const double upper = factor(k, j);
      factor(k, j) = c * upper + s * row[j];
      row[j] = c * row[j] - s * upper;
    }
  }
}

/** Coefficients of the fit of degree `degree`, from the leading columns of the factor. */
template <typename Block>
void solve(const Factor& factor, int degree, Block&& coefficients)
{
  coefficients.setZero();
  for (int k = degree; k >= 0; --k)
  {
    Eigen::RowVector2d value = factor.block<1, 2>(k, terms);
    for (int j = k + 1; j <= degree; ++j)
    {
      value -= factor(k, j) * coefficients.row(j);
    }
    coefficients.row(k) = value / factor(k, k);
  }
}

/** Variance of a linear function of the coefficients per unit of noise variance: |R^-T row|^2. */
double leverage(const Factor& factor, int degree, const std::array<double, terms>& row)
{
  std::array<double, terms> root{};
  double sum = 0;
  for (int k = 0; k <= degree; ++k)
  {
    const auto at = static_cast<std::size_t>(k);
    double value = row[at];
    for (int j = 0; j < k; ++j)
    {
      value -= factor(j, k) * root[static_cast<std::size_t>(j)];
    }
    root[at] = value / factor(k, k);
    sum += root[at] * root[at];
  }
  return sum;
}

/** Powers 1, tau, tau^2, ... */
std::array<double, terms> powersOf(double tau)
{
  std::array<double, terms> powers{};
  powers[0] = 1;
  for (std::size_t k = 1; k < powers.size(); ++k)
  {
    powers[k] = powers[k - 1] * tau;
  }
  return powers;
}
}  // namespace

AdaptivePredictor::AdaptivePredictor(const AdaptiveOptions& options) : options_(options)
{
  if (!(options.forgetting_factor > 0 && options.forgetting_factor <= 1) ||
      !(options.regularisation > 0) || !(options.prior_weight > 0) ||
      !(options.noise_weight >= 0) || !(options.outlier_sigmas > 0) || !(options.min_sigma > 0))
  {
    throw std::invalid_argument(
        "AdaptivePredictor: forgetting_factor must be in (0, 1], noise_weight not negative, "
        "regularisation, prior_weight, outlier_sigmas and min_sigma above 0");
  }
  coefficients_.setZero();
  error_covariance_.setZero();
  updateWeights();
}

bool AdaptivePredictor::add(const TimedPosition& observation)
{
  if (!std::isfinite(observation.stamp) || !observation.position.allFinite() ||
      (!history_.empty() && observation.stamp <= history_.back().stamp))
  {
    return false;
  }
  TimedPosition stored = observation;
  if (history_.size() >= 2)
  {
    stored.position = clipOutlier(observation);
    updateErrorStatistics(observation);
  }
  history_.push_back(stored);
  if (history_.size() > static_cast<std::size_t>(bank.back().window))
  {
    history_.pop_front();
  }
  refit();
  return true;
}

/** The position to store for an observation: clipped to the gate around the prediction if it is an
 * outlier. */
Eigen::Vector2d AdaptivePredictor::clipOutlier(const TimedPosition& observation)
{
  constexpr double min_error_count = 8;
  if (error_count_ <= min_error_count)
  {
    return observation.position;
  }
  const Eigen::Vector2d predicted = predict(observation.stamp).position;
  const Eigen::Vector2d innovation = observation.position - predicted;
  const double least = options_.min_sigma * options_.min_sigma;
  const Eigen::Matrix2d covariance =
      combined_error_covariance_ / error_count_ + least * Eigen::Matrix2d::Identity();
  const double mahalanobis_distance = std::sqrt(innovation.dot(covariance.llt().solve(innovation)));
  const bool outlier = mahalanobis_distance > options_.outlier_sigmas;
  if (unclipped_position_)
  {
    if (outlier)  // two outliers in a row are a manoeuvre: both are used unclipped
    {
      history_.back().position = *unclipped_position_;
      refit();
    }
    unclipped_position_.reset();
    return observation.position;
  }
  if (!outlier)
  {
    return observation.position;
  }
  unclipped_position_ = observation.position;
  return predicted + innovation * (options_.outlier_sigmas / mahalanobis_distance);
}

void AdaptivePredictor::shift(const Eigen::Vector2d& offset)
{
  for (TimedPosition& observation : history_)
  {
    observation.position += offset;
  }
  if (unclipped_position_)
  {
    *unclipped_position_ += offset;
  }
  origin_ += offset;  // the coefficients are relative to the origin
}

void AdaptivePredictor::updateErrorStatistics(const TimedPosition& observation)
{
  Positions errors = memberPredictions(observation.stamp);
  errors.rowwise() -= observation.position.transpose();
  const Eigen::RowVector2d own = weights_.transpose() * errors;
  combined_error_covariance_ =
      options_.forgetting_factor * combined_error_covariance_ + own.transpose() * own;
  error_covariance_ *= options_.forgetting_factor;
  error_covariance_.noalias() += errors * errors.transpose();
  error_count_ = options_.forgetting_factor * error_count_ + 1;
  updateWeights();
}

void AdaptivePredictor::updateWeights()
{
  velocity_weights_ = Weights::Zero();
  if (error_count_ == 0)
  {
    weights_ = Weights::Zero();
    weights_[0] = 1;  // all members are equal with such a short history
    velocity_weights_[0] = 1;
    return;
  }
  const Weights variance = error_covariance_.diagonal() / error_count_;
  const double least = std::max(variance.minCoeff(), 1e-12);
  Eigen::Matrix<double, members, members> damped = error_covariance_ / error_count_;
  damped.diagonal().array() += options_.regularisation * least;
  const double error_share = error_count_ / (error_count_ + options_.noise_weight);
  damped *= error_share;
  damped.diagonal() += (1 - error_share) * least * noise_gain_;
  weights_ = damped.llt().solve(Weights::Ones());
  weights_ /= weights_.sum();

  // Velocities and long-term predictions: low degrees only, with positive weights.
  for (Eigen::Index i = 0; i < members; ++i)
  {
    if (bank[static_cast<std::size_t>(i)].degree <= 2)
    {
      const double ratio = (least + 1e-12) / (variance[i] + 1e-12);
      velocity_weights_[i] = ratio * ratio;
    }
  }
  velocity_weights_ /= velocity_weights_.sum();
}

void AdaptivePredictor::refit()
{
  Factor factor = Factor::Zero();
  origin_ = history_.back().position;
  const double newest = history_.back().stamp;
  const double span = newest - history_.front().stamp;
  time_scale_ = span > 0 ? span : 1;
  const auto count = static_cast<int>(history_.size());
  int rows = 0;
  const double step = count > 1 ? span / (count - 1) : 0.0;
  const std::array<double, terms> next = powersOf(step / time_scale_);
  for (std::size_t member = 0; member < bank.size(); ++member)
  {
    const Fit& fit = bank[member];
    for (; rows < std::min(fit.window, count); ++rows)
    {
      const TimedPosition& observation = history_[static_cast<std::size_t>(count - 1 - rows)];
      Equation equation;
      const double tau = (observation.stamp - newest) / time_scale_;
      equation[0] = 1;
      for (int k = 1; k < terms; ++k)
      {
        equation[k] = equation[k - 1] * tau;
      }
      equation.tail<2>() = (observation.position - origin_).transpose();
      addRow(factor, equation);
    }
    const int degree = std::min(fit.degree, rows - 1);
    const auto i = static_cast<Eigen::Index>(member);
    velocity_leverage_[i] = leverage(factor, degree, {0, 1}) / (time_scale_ * time_scale_);
    noise_gain_[i] = leverage(factor, degree, next);
    solve(factor, degree, coefficients_.middleRows<terms>(i * terms));
  }
}

AdaptivePredictor::Positions AdaptivePredictor::memberPredictions(double stamp) const
{
  const double tau = (stamp - history_.back().stamp) / time_scale_;
  Eigen::Matrix<double, 1, terms> powers;
  powers[0] = 1;
  for (int k = 1; k < terms; ++k)
  {
    powers[k] = powers[k - 1] * tau;
  }
  Positions predictions;
  for (Eigen::Index i = 0; i < members; ++i)
  {
    predictions.row(i) = powers * coefficients_.middleRows<terms>(i * terms);
    predictions.row(i) += origin_.transpose();
  }
  return predictions;
}

MotionPrediction AdaptivePredictor::predict(double stamp) const
{
  MotionPrediction prediction;
  if (history_.empty() || !std::isfinite(stamp))
  {
    return prediction;
  }
  const double usual = history_.size() > 1 ? (history_.back().stamp - history_.front().stamp) /
                                                 static_cast<double>(history_.size() - 1)
                                           : 0.0;
  const double horizon = stamp - history_.back().stamp;
  // The weights hold for one observation ahead; beyond that the prediction is linear.
  const double trained_horizon = history_.size() > 1 ? std::min(horizon, 1.5 * usual) : horizon;
  const Positions predictions = memberPredictions(history_.back().stamp + trained_horizon);
  const double tau = trained_horizon / time_scale_;
  for (Eigen::Index i = 0; i < members; ++i)
  {
    double power = 1 / time_scale_;
    for (int k = 1; k < terms; ++k)
    {
      prediction.velocity +=
          velocity_weights_[i] * k * power * coefficients_.row(i * terms + k).transpose();
      power *= tau;
    }
  }
  prediction.position = (weights_.transpose() * predictions).transpose() +
                        (horizon - trained_horizon) * prediction.velocity;
  prediction.valid = true;
  prediction.samples = history_.size();
  Eigen::Index largest = 0;
  velocity_weights_.maxCoeff(&largest);
  prediction.degree = std::min(bank[static_cast<std::size_t>(largest)].degree,
                               static_cast<int>(history_.size()) - 1);

  setCovariances(horizon, trained_horizon, usual, prediction);
  return prediction;
}

void AdaptivePredictor::setCovariances(double horizon,
                                       double trained_horizon,
                                       double usual_interval,
                                       MotionPrediction& prediction) const
{
  const double prior = options_.prior_sigma * options_.prior_sigma;
  prediction.covariance =
      (combined_error_covariance_ + options_.prior_weight * prior * Eigen::Matrix2d::Identity()) /
      (error_count_ + options_.prior_weight);
  const Eigen::Matrix2d noise = prediction.covariance;
  const double slope_sigma = (velocity_weights_.array() * velocity_leverage_.array().sqrt())
                                 .sum();  // the members' errors are correlated
  prediction.velocity_covariance = slope_sigma * slope_sigma * noise;
  if (history_.size() < 2)
  {
    prediction.velocity_covariance =
        options_.initial_speed_sigma * options_.initial_speed_sigma * Eigen::Matrix2d::Identity();
    prediction.covariance += horizon * horizon * prediction.velocity_covariance;
    return;
  }
  if (history_.size() < 3)
  {
    prediction.covariance *= 1 + noise_gain_[0];  // no past errors yet: error of the fit by noise
  }
  // Past errors are those of one step ahead; the covariance grows with longer predictions.
  const double unmodelled_time = history_.size() < 3 ? horizon : horizon - trained_horizon;
  const double manoeuvre = 0.5 * options_.acceleration_sigma * unmodelled_time * unmodelled_time;
  const double steps = usual_interval > 0 ? std::max(1.0, horizon / usual_interval) : 1.0;
  prediction.covariance *= steps;
  prediction.covariance += manoeuvre * manoeuvre * Eigen::Matrix2d::Identity();
}

void AdaptivePredictor::exchangeState(StateArchive& archive)
{
  archive(options_, history_, coefficients_, velocity_leverage_, noise_gain_, unclipped_position_,
          origin_, time_scale_, error_covariance_, error_count_, combined_error_covariance_,
          weights_, velocity_weights_);
}
}  // namespace dyslam
