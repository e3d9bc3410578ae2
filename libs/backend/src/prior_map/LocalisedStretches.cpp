// SPDX-License-Identifier: BSD-3-Clause
#include "LocalisedStretches.h"

#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/MotionAccumulator.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double expected_mahalanobis = 6;  // squared, of six numbers
/** A stretch was at a wrong place if without it the odometry errs by less than this fraction. */
constexpr double least_gain = 1.0 / 3;

const MapFix& firstStrong(const std::vector<MapFix>& fixes)
{
  const auto found =
      std::find_if(fixes.begin(), fixes.end(), [](const MapFix& fix) { return !fix.is_weak; });
  if (found == fixes.end())
  {
    throw std::invalid_argument("LocalisedStretches: all fixes of the new stretch are weak");
  }
  return *found;
}
}  // namespace

FactorGraph::FactorId LocalisedStretches::odometryTo(std::size_t keyframe) const
{
  const FactorIds& ids = graph_.factorsOf(Key::ego(keyframe));
  const auto found =
      std::find_if(ids.begin(), ids.end(),
                   [&](FactorGraph::FactorId id)
                   {
                     const Factor& factor = graph_.factor(id);
                     return factor.is<OdometryFactor>() && factor.keys()[1] == Key::ego(keyframe);
                   });
  if (found == ids.end())
  {
    throw std::invalid_argument("LocalisedStretches: no odometry to keyframe " +
                                std::to_string(keyframe));
  }
  return *found;
}

LocalisedStretches::Error LocalisedStretches::errorBetween(const MapFix& older,
                                                           const MapFix& newer) const
{
  MotionAccumulator odometry;
  for (std::size_t k = older.keyframe + 1; k <= newer.keyframe; ++k)
  {
    const Factor& factor = graph_.factor(odometryTo(k));
    odometry.add(factor.measurement(), factor.information().inverse(), Matrix6::Zero());
  }
  const Pose T_error =
      odometry.motion().inverse() * older.T_prior_vehicle.inverse() * newer.T_prior_vehicle;
  const Vector6 error = logSE3(T_error);
  Error result;
  result.distance = T_error.translation().norm();
  result.is_drift = result.distance <= driftRadius(keyframes_, older.keyframe, newer.keyframe) &&
                    rotationAngle(T_error) <= drift_heading;
  result.mahalanobis = error.dot(odometry.covariance().ldlt().solve(error));
  return result;
}

void LocalisedStretches::scaleOdometry(std::size_t from, std::size_t to, double factor)
{
  for (std::size_t k = from + 1; factor != 1 && k <= to; ++k)
  {
    const FactorGraph::FactorId id = odometryTo(k);
    auto scaled = std::make_unique<OdometryFactor>(k - 1, k, graph_.factor(id).measurement(),
                                                   graph_.factor(id).information() / factor);
    graph_.removeFactor(id);
    graph_.add(std::move(scaled));
  }
}

void LocalisedStretches::forgetFrom(std::size_t begin)
{
  for (std::size_t i = begin; i < stretches_.size(); ++i)
  {
    scaleOdometry(stretches_[i - 1].last.keyframe, stretches_[i].strong,
                  1 / stretches_[i].odometry_scale);
  }
  stretches_.resize(begin);
}

LocalisedStretches::FactorIds LocalisedStretches::removeLocalisations(std::size_t first)
{
  FactorIds removed;
  for (const FactorGraph::FactorId id : graph_.factorsOf(Key::priorMap()))
  {
    if (static_cast<std::size_t>(graph_.factor(id).keys()[1].index) >= first)
    {
      removed.push_back(id);
    }
  }
  for (const FactorGraph::FactorId id : removed)
  {
    graph_.removeFactor(id);
  }
  square_errors_.erase(square_errors_.lower_bound(first), square_errors_.end());
  return removed;
}

LocalisedStretches::FactorIds LocalisedStretches::begin(const std::vector<MapFix>& fixes)
{
  const MapFix& strong = firstStrong(fixes);
  Stretch next;
  next.first = fixes.front().keyframe;
  next.strong = strong.keyframe;
  next.last = strong;
  FactorIds removed;
  if (!stretches_.empty())
  {
    Error error = errorBetween(stretches_.back().last, strong);
    std::size_t wrong_since = next.first;  // keyframe
    for (std::size_t i = stretches_.size() - 1; !error.is_drift && i > 0; --i)
    {
      const Error without = errorBetween(stretches_[i - 1].last, strong);
      if (without.is_drift && without.distance < least_gain * stretches_[i].jump)
      {
        wrong_since = stretches_[i].first;
        forgetFrom(i);
        error = errorBetween(stretches_.back().last, strong);
      }
    }
    if (!error.is_drift)
    {
      wrong_since = stretches_.back().last.keyframe + 1;  // weak fixes where the odometry led to
    }
    removed = removeLocalisations(wrong_since);
    next.jump = error.distance;
    if (std::isfinite(error.mahalanobis))
    {
      next.odometry_scale = std::max(1.0, error.mahalanobis / expected_mahalanobis);
      scaleOdometry(stretches_.back().last.keyframe, next.strong, next.odometry_scale);
    }
  }
  stretches_.push_back(next);
  return removed;
}

LocalisedStretches::FactorIds LocalisedStretches::add(const std::vector<MapFix>& fixes)
{
  FactorIds added;
  for (const MapFix& fix : fixes)
  {
    added.push_back(graph_.add(
        std::make_unique<LocalisationFactor>(fix.keyframe, fix.T_prior_vehicle, fix.information)));
    square_errors_[fix.keyframe] = fix.rmse * fix.rmse;
    if (!fix.is_weak)
    {
      stretches_.back().last = fix;
    }
  }
  return added;
}

double LocalisedStretches::rmse() const
{
  double sum = 0;
  for (const auto& [keyframe, square_error] : square_errors_)
  {
    sum += square_error;
  }
  return square_errors_.empty() ? 0 : std::sqrt(sum / static_cast<double>(square_errors_.size()));
}

void LocalisedStretches::exchangeState(StateArchive& archive)
{
  archive(stretches_, square_errors_);
}
}  // namespace dyslam
