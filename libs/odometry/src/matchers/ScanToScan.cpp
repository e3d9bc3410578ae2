// SPDX-License-Identifier: BSD-3-Clause
#include "ScanToScan.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>

#include "CloudCheck.h"

namespace dyslam
{
namespace
{
/** Number of failures in a row after which the reference is too old. */
constexpr int max_failures = 3;
}  // namespace

ScanMatch ScanToScan::match(const Frame& frame, const MotionPrior& prior)
{
  ScanMatch match;
  match.motion = find(frame, prior);
  match.static_confidence = staticConfidence();
  return match;
}

MotionEstimate ScanToScan::find(const Frame& frame, const MotionPrior& prior)
{
  MotionEstimate estimate;
  const Pose prediction = orthonormalised(prior.T_previous_current);
  estimate.T_previous_current = has_reference_ ? prediction : Pose::Identity();
  estimate.information.setZero();
  setReasonUnusable(frame, estimate);
  const std::string unusable = extract(frame);
  if (estimate.reason.empty())
  {
    estimate.reason = unusable;
  }
  const Pose guess = T_reference_previous_ * estimate.T_previous_current;
  if (!estimate.reason.empty())
  {
    T_reference_previous_ = has_reference_ ? guess : Pose::Identity();
    return estimate;
  }
  if (!has_reference_)
  {
    accept(Pose::Identity());
    has_reference_ = true;
    estimate.status = MotionStatus::converged;
    return estimate;
  }
  guess_information_ = referenceIsPrevious() ? prior.information : Matrix6(Matrix6::Zero());
  MotionEstimate found = align(guess);
  if (!found.registered())
  {
    found.T_previous_current = prediction;
    T_reference_previous_ = guess;
    if (++failures_ >= max_failures)
    {
      accept(guess);
      T_reference_previous_.setIdentity();
      failures_ = 0;
    }
    return found;
  }
  accept(found.T_previous_current);
  found.T_previous_current =
      orthonormalised(T_reference_previous_.inverse() * found.T_previous_current);
  T_reference_previous_.setIdentity();
  failures_ = 0;
  return found;
}

void ScanToScan::exchangeState(StateArchive& archive)
{
  archive(has_reference_, T_reference_previous_, failures_);
  exchangeReference(archive);
}

std::vector<float> pointWeights(const Frame& frame)
{
  const std::size_t count = frame.cloud.size();
  const bool has_moving = frame.moving_probability.size() == count;
  const bool has_static = frame.static_confidence.size() == count;
  std::vector<float> weights;
  if (!has_moving && !has_static)
  {
    return weights;
  }
  weights.resize(count, 1.0F);
  for (std::size_t i = 0; i < count; ++i)
  {
    float w = has_moving ? 1 - frame.moving_probability[i] : 1.0F;
    w *= has_static ? frame.static_confidence[i] : 1.0F;
    weights[i] = w > 0 ? std::min(w, 1.0F) : 0.0F;
  }
  return weights;
}
}  // namespace dyslam
