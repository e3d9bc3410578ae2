// SPDX-License-Identifier: BSD-3-Clause
#include "GyroscopeClock.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double max_lag = 1;      //!< [s]
constexpr double lag_step = 0.02;  //!< [s]
constexpr std::size_t most_waiting = 100;
// Evidence for an offset.
constexpr std::size_t min_rotations = 50;
constexpr double min_turning = 2 * radians_per_degree;  //!< deviation of the rates [rad/s]
constexpr double max_unexplained = 0.4;
/** What offsets that are off by half or more leave unexplained is at least `min_ratio` of the
 * least, plus `min_more`. */
constexpr double min_ratio = 2;
constexpr double min_more = 0.002;
constexpr double min_offset = 0.1;  //!< larger than the delays of filters within a unit [s]

double lagAt(std::size_t i)
{
  return static_cast<double>(i) * lag_step - max_lag;
}

/** Integral of angular velocities, linear between their samples, over an interval. */
class Integral
{
 public:
  /** \pre rates.isComplete() over the interval */
  Integral(const SampledSignal<Eigen::Vector3d>& rates, double begin, double end) : stamps_{begin}
  {
    rates.addStampsWithin(stamps_);
    stamps_.push_back(end);
    for (const double stamp : stamps_)
    {
      rates_.push_back(rates.at(stamp));
    }
    sums_.push_back(Eigen::Vector3d::Zero());
    for (std::size_t i = 1; i < stamps_.size(); ++i)
    {
      sums_.push_back(sums_.back() +
                      0.5 * (stamps_[i] - stamps_[i - 1]) * (rates_[i] + rates_[i - 1]));
    }
  }

  /** From the begin to `t` [rad]. */
  [[nodiscard]] Eigen::Vector3d to(double t) const
  {
    const auto after = std::upper_bound(stamps_.begin() + 1, stamps_.end() - 1, t);
    const auto i = static_cast<std::size_t>(after - stamps_.begin());
    const double since = t - stamps_[i - 1];
    const Eigen::Vector3d slope = (rates_[i] - rates_[i - 1]) / (stamps_[i] - stamps_[i - 1]);
    return sums_[i - 1] + since * (rates_[i - 1] + 0.5 * since * slope);
  }

 private:
  std::vector<double> stamps_;
  std::vector<Eigen::Vector3d> rates_;
  std::vector<Eigen::Vector3d> sums_;
};
}  // namespace

void GyroscopeClock::add(double begin, double end, const Eigen::Vector3d& rate)
{
  waiting_.push_back({begin, end, rate});
  if (waiting_.size() > most_waiting)
  {
    waiting_.pop_front();
  }
}

void GyroscopeClock::compare(const Rates& rates, double max_gap)
{
  while (!waiting_.empty() && !rates.empty() &&
         waiting_.front().end + max_lag <= rates.back().stamp)
  {
    const Rotation rotation = waiting_.front();
    waiting_.pop_front();
    const double begin = rotation.begin - max_lag;
    const double end = rotation.end + max_lag;
    const SampledSignal<Eigen::Vector3d> signal(rates, begin, end, max_gap);
    if (!signal.isComplete() || rates.front().stamp > begin)
    {
      continue;
    }
    const Integral integral(signal, begin, end);
    ++compared_;
    of_scans_.sum += rotation.rate;
    of_scans_.squares += rotation.rate.squaredNorm();
    for (std::size_t i = 0; i < lags; ++i)
    {
      const double lag = lagAt(i);
      const Eigen::Vector3d rate =
          (integral.to(rotation.end + lag) - integral.to(rotation.begin + lag)) /
          (rotation.end - rotation.begin);
      of_gyroscope_[i].sum += rate;
      of_gyroscope_[i].squares += rate.squaredNorm();
      of_gyroscope_[i].products += rate.dot(rotation.rate);
    }
  }
}

double GyroscopeClock::varianceOf(const Sums& sums) const
{
  const auto n = static_cast<double>(compared_);
  return (sums.squares - sums.sum.squaredNorm() / n) / n;
}

std::array<double, GyroscopeClock::lags> GyroscopeClock::unexplained() const
{
  const auto n = static_cast<double>(compared_);
  std::array<double, lags> result{};
  for (std::size_t i = 0; i < lags; ++i)
  {
    const Sums& sums = of_gyroscope_[i];
    const double covariance = (sums.products - sums.sum.dot(of_scans_.sum) / n) / n;
    const double variances = varianceOf(sums) * varianceOf(of_scans_);
    const double correlation = variances > 0 ? std::max(0.0, covariance / std::sqrt(variances)) : 0;
    result[i] = std::max(0.0, 1 - correlation * correlation);
  }
  return result;
}

std::optional<double> GyroscopeClock::offset() const
{
  if (compared_ < min_rotations || varianceOf(of_scans_) < min_turning * min_turning)
  {
    return std::nullopt;
  }
  const std::array<double, lags> left = unexplained();
  const auto best =
      static_cast<std::size_t>(std::min_element(left.begin(), left.end()) - left.begin());
  if (best == 0 || best + 1 == lags || left[best] > max_unexplained)
  {
    return std::nullopt;
  }
  const double curvature = left[best - 1] - 2 * left[best] + left[best + 1];
  const double offset =
      lagAt(best) +
      (curvature > 0 ? 0.5 * lag_step * (left[best - 1] - left[best + 1]) / curvature : 0);
  if (std::abs(offset) < min_offset)
  {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < lags; ++i)
  {
    if (std::abs(lagAt(i) - offset) >= 0.5 * std::abs(offset) &&
        left[i] < min_ratio * left[best] + min_more)
    {
      return std::nullopt;
    }
  }
  return offset;
}

void GyroscopeClock::exchangeState(StateArchive& archive)
{
  archive(waiting_, compared_, of_scans_, of_gyroscope_);
}
}  // namespace dyslam
