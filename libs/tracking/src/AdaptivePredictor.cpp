// SPDX-License-Identifier: BSD-3-Clause
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
/** [1, tau, ..., tau^5 | x, y], triangular. */
using Factor = Eigen::Matrix<double, terms, terms + 2, Eigen::RowMajor>;
using Equation = Eigen::Matrix<double, 1, terms + 2, Eigen::RowMajor>;

/** Rotate one more equation into the triangular factor (Givens). */
void rotateIn(Factor& factor, Equation row)
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

/** The fit of the given degree: its columns lead the factor. */
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

/** Variance of a linear function of the coefficients per unit of noise: |R^-T row|^2. */
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

/** 1, tau, tau^2, ... */
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
  if (!(options.memory > 0 && options.memory <= 1) || !(options.regularisation > 0) ||
      !(options.prior_weight > 0) || !(options.noise_weight >= 0) ||
      !(options.outlier_sigmas > 0) || !(options.least_sigma > 0))
  {
    throw std::invalid_argument(
        "AdaptivePredictor: memory must be in (0, 1], noise_weight not negative, regularisation, "
        "prior_weight, outlier_sigmas and least_sigma above 0");
  }
  coefficients_.setZero();
  error_covariance_.setZero();
  reweigh();
}

bool AdaptivePredictor::add(const TimedPosition& sighting)
{
  if (!std::isfinite(sighting.stamp) || !sighting.position.allFinite() ||
      (!history_.empty() && sighting.stamp <= history_.back().stamp))
  {
    return false;
  }
  TimedPosition taken = sighting;
  if (history_.size() >= 2)
  {
    taken.position = drawnIn(sighting);
    learn(sighting);
  }
  history_.push_back(taken);
  if (history_.size() > static_cast<std::size_t>(bank.back().window))
  {
    history_.pop_front();
  }
  refit();
  return true;
}

/** The position to remember of a sighting, drawn towards the prediction if it lies far off. */
Eigen::Vector2d AdaptivePredictor::drawnIn(const TimedPosition& sighting)
{
  constexpr double enough_errors = 8;
  if (error_count_ <= enough_errors)
  {
    return sighting.position;
  }
  const Eigen::Vector2d expected = predict(sighting.stamp).position;
  const Eigen::Vector2d off = sighting.position - expected;
  const double least = options_.least_sigma * options_.least_sigma;
  const Eigen::Matrix2d usual = own_errors_ / error_count_ + least * Eigen::Matrix2d::Identity();
  const double sigmas = std::sqrt(off.dot(usual.llt().solve(off)));
  const bool far = sigmas > options_.outlier_sigmas;
  if (drawn_from_)
  {
    if (far)  // no outlier but a change of course: both are as they were seen
    {
      history_.back().position = *drawn_from_;
      refit();
    }
    drawn_from_.reset();
    return sighting.position;
  }
  if (!far)
  {
    return sighting.position;
  }
  drawn_from_ = sighting.position;
  return expected + off * (options_.outlier_sigmas / sigmas);
}

void AdaptivePredictor::shift(const Eigen::Vector2d& offset)
{
  for (TimedPosition& sighting : history_)
  {
    sighting.position += offset;
  }
  if (drawn_from_)
  {
    *drawn_from_ += offset;
  }
  origin_ += offset;  // the fits are told relative to it
}

void AdaptivePredictor::learn(const TimedPosition& sighting)
{
  Positions errors = memberPredictions(sighting.stamp);
  errors.rowwise() -= sighting.position.transpose();
  const Eigen::RowVector2d own = weights_.transpose() * errors;
  own_errors_ = options_.memory * own_errors_ + own.transpose() * own;
  error_covariance_ *= options_.memory;
  error_covariance_.noalias() += errors * errors.transpose();
  error_count_ = options_.memory * error_count_ + 1;
  reweigh();
}

void AdaptivePredictor::reweigh()
{
  velocity_weights_ = Weights::Zero();
  if (error_count_ == 0)
  {
    weights_ = Weights::Zero();
    weights_[0] = 1;  // all agree while the history is as short as this
    velocity_weights_[0] = 1;
    return;
  }
  const Weights variance = error_covariance_.diagonal() / error_count_;
  const double least = std::max(variance.minCoeff(), 1e-12);
  Eigen::Matrix<double, members, members> damped = error_covariance_ / error_count_;
  damped.diagonal().array() += options_.regularisation * least;
  const double known = error_count_ / (error_count_ + options_.noise_weight);
  damped *= known;
  damped.diagonal() += (1 - known) * least * noise_gain_;
  weights_ = damped.llt().solve(Weights::Ones());
  weights_ /= weights_.sum();

  // Velocities and far predictions: steep polynomials have no say, weights stay positive.
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
      const TimedPosition& sighting = history_[static_cast<std::size_t>(count - 1 - rows)];
      Equation equation;
      const double tau = (sighting.stamp - newest) / time_scale_;
      equation[0] = 1;
      for (int k = 1; k < terms; ++k)
      {
        equation[k] = equation[k - 1] * tau;
      }
      equation.tail<2>() = (sighting.position - origin_).transpose();
      rotateIn(factor, equation);
    }
    const int degree = std::min(fit.degree, rows - 1);
    const auto i = static_cast<Eigen::Index>(member);
    slope_leverage_[i] = leverage(factor, degree, {0, 1}) / (time_scale_ * time_scale_);
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
  const double ahead = stamp - history_.back().stamp;
  // The weights were learnt one sighting ahead; beyond that the combination moves on straight.
  const double near = history_.size() > 1 ? std::min(ahead, 1.5 * usual) : ahead;
  const Positions predictions = memberPredictions(history_.back().stamp + near);
  const double tau = near / time_scale_;
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
  prediction.position =
      (weights_.transpose() * predictions).transpose() + (ahead - near) * prediction.velocity;
  prediction.valid = true;
  prediction.samples = history_.size();
  Eigen::Index heaviest = 0;
  velocity_weights_.maxCoeff(&heaviest);
  prediction.degree = std::min(bank[static_cast<std::size_t>(heaviest)].degree,
                               static_cast<int>(history_.size()) - 1);

  const double prior = options_.prior_sigma * options_.prior_sigma;
  prediction.covariance =
      (own_errors_ + options_.prior_weight * prior * Eigen::Matrix2d::Identity()) /
      (error_count_ + options_.prior_weight);
  const Eigen::Matrix2d noise = prediction.covariance;
  const double slope_sigma =
      (velocity_weights_.array() * slope_leverage_.array().sqrt()).sum();  // fits share their noise
  prediction.velocity_covariance = slope_sigma * slope_sigma * noise;
  if (history_.size() < 2)
  {
    prediction.velocity_covariance =
        options_.first_speed_sigma * options_.first_speed_sigma * Eigen::Matrix2d::Identity();
    prediction.covariance += ahead * ahead * prediction.velocity_covariance;
    return prediction;
  }
  // Past errors were made one step ahead; doubt grows with what was not yet seen.
  const double unseen = history_.size() < 3 ? ahead : ahead - near;
  const double doubt = 0.5 * options_.acceleration_sigma * unseen * unseen;
  const double steps = usual > 0 ? std::max(1.0, ahead / usual) : 1.0;
  prediction.covariance *= steps;
  prediction.covariance += doubt * doubt * Eigen::Matrix2d::Identity();
  return prediction;
}
}  // namespace dyslam
