// SPDX-License-Identifier: BSD-3-Clause
#include "ConstantMotion.h"

#include <dyslam/base/Angle.h>

#include "CloudCheck.h"

namespace dyslam
{
ScanMatch ConstantMotion::match(const Frame& frame, const MotionPrior& prior)
{
  ScanMatch match;
  match.motion.information = informationFromSigmas(0.1, radians_per_degree);
  setReasonUnusable(frame, match.motion);
  match.motion.status =
      match.motion.reason.empty() ? MotionStatus::converged : MotionStatus::not_found;
  const bool first = first_;
  first_ = false;
  if (!first && (kind_ == Kind::constant_velocity || !match.motion.registered()))
  {
    match.motion.T_previous_current = prior.T_previous_current;
  }
  return match;
}

std::string ConstantMotion::name() const
{
  return kind_ == Kind::constant_velocity ? "constant_velocity" : "zero_motion";
}
}  // namespace dyslam
