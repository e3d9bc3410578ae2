// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/tracking/PolynomialTrajectory.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr int terms_max = PolynomialTrajectory::max_degree + 1;
using Design = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Eigen::Dynamic, terms_max>;
using Values = Eigen::Matrix<double, Eigen::Dynamic, 2>;
using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, terms_max, 2>;
using Row = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, terms_max>;

/** Powers 1, t, t^2, ... */
Row powers(double t, int degree)
{
  Row row(degree + 1);
  row[0] = 1;
  for (int k = 1; k <= degree; ++k)
  {
    row[k] = row[k - 1] * t;
  }
  return row;
}

/** Derivatives of the powers: 0, 1, 2 t, ... */
Row slopes(double t, int degree)
{
  Row row(degree + 1);
  row[0] = 0;
  double power = 1;
  for (int k = 1; k <= degree; ++k)
  {
    row[k] = k * power;
    power *= t;
  }
  return row;
}
}  // namespace

PolynomialTrajectory::PolynomialTrajectory(const PolynomialOptions& options) : options_(options)
{
  if (options.degree < 0 || options.degree > max_degree || options.window < 1)
  {
    throw std::invalid_argument("PolynomialTrajectory: degree must be 0 to 5, window at least 1");
  }
  if (options_.model == MotionModel::constant_velocity)
  {
    options_.degree = 1;
    options_.window = 2;
  }
}

bool PolynomialTrajectory::add(const TimedPosition& observation)
{
  if (!std::isfinite(observation.stamp) || !observation.position.allFinite() ||
      (!history_.empty() && observation.stamp <= history_.back().stamp))
  {
    return false;
  }
  history_.push_back(observation);
  if (history_.size() > static_cast<std::size_t>(options_.window))
  {
    history_.pop_front();
  }
  return true;
}

void PolynomialTrajectory::shift(const Eigen::Vector2d& offset)
{
  for (TimedPosition& observation : history_)
  {
    observation.position += offset;
  }
}

bool PolynomialTrajectory::full() const
{
  return history_.size() == static_cast<std::size_t>(options_.window);
}

MotionPrediction PolynomialTrajectory::predict(double stamp) const
{
  MotionPrediction prediction;
  if (history_.empty() || !std::isfinite(stamp))
  {
    return prediction;
  }
  const auto count = static_cast<Eigen::Index>(history_.size());
  const int degree = std::min(options_.degree, static_cast<int>(count) - 1);
  const double middle = 0.5 * (history_.front().stamp + history_.back().stamp);
  const double half = 0.5 * (history_.back().stamp - history_.front().stamp);
  const double scale = half > 0 ? 1 / half : 1;

  Design design(count, degree + 1);
  Values values(count, 2);
  const Eigen::Vector2d origin = history_.back().position;  // map coordinates may be large
  for (Eigen::Index i = 0; i < count; ++i)
  {
    const TimedPosition& observation = history_[static_cast<std::size_t>(i)];
    design.row(i) = powers((observation.stamp - middle) * scale, degree);
    values.row(i) = (observation.position - origin).transpose();
  }
  const Eigen::HouseholderQR<Design> qr(design);
  Values rotated = values;
  rotated.applyOnTheLeft(qr.householderQ().adjoint());
  const auto upper = qr.matrixQR().topRows(degree + 1).triangularView<Eigen::Upper>();
  const Coefficients coefficients = upper.solve(rotated.topRows(degree + 1));

  const double t = (stamp - middle) * scale;
  prediction.valid = true;
  prediction.degree = degree;
  prediction.samples = history_.size();
  prediction.position = origin + (powers(t, degree) * coefficients).transpose();
  prediction.velocity = scale * (slopes(t, degree) * coefficients).transpose();

  // Observation covariance from the residuals and the prior.
  const Eigen::Index redundancy = count - (degree + 1);
  const Values residuals = rotated.bottomRows(redundancy);
  Eigen::Matrix2d noise = options_.prior_weight * options_.prior_sigma * options_.prior_sigma *
                          Eigen::Matrix2d::Identity();
  noise.noalias() += residuals.transpose() * residuals;
  noise /= options_.prior_weight + static_cast<double>(redundancy);
  using Root = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, terms_max, 1>;
  const Root leverage_root = upper.transpose().solve(powers(t, degree).transpose());
  const Root slope_root = upper.transpose().solve(slopes(t, degree).transpose());
  const double horizon = stamp - history_.back().stamp;
  const double unmodelled =
      redundancy > 0 ? 0.0 : 0.5 * options_.acceleration_sigma * horizon * horizon;
  prediction.covariance = noise * (1 + leverage_root.squaredNorm()) +
                          unmodelled * unmodelled * Eigen::Matrix2d::Identity();
  prediction.velocity_covariance = noise * (scale * scale * slope_root.squaredNorm());
  if (degree == 0)
  {
    prediction.velocity_covariance =
        options_.initial_speed_sigma * options_.initial_speed_sigma * Eigen::Matrix2d::Identity();
    prediction.covariance += horizon * horizon * prediction.velocity_covariance;
  }
  return prediction;
}

void PolynomialTrajectory::exchangeState(StateArchive& archive)
{
  archive(options_, history_);
}
}  // namespace dyslam
