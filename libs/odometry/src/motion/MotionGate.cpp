// SPDX-License-Identifier: BSD-3-Clause
#include "MotionGate.h"

#include <dyslam/base/Printable.h>

#include <algorithm>

namespace dyslam
{
/** Estimated from static classes, the segmenter's motion is not biased by surrounding traffic. Two
 * scans that were deskewed by different motions do not determine the motion between them. */
bool MotionGate::acceptsSegmenterMotion(const Frame& frame, const Pose& T_sweep_previous) const
{
  if (!frame.segmenter_motion || frame.static_prior.empty() || frame.dt <= 0)
  {
    return false;
  }
  const Pose sweep_change = T_sweep_previous.inverse() * frame.cloud.T_sweep;
  return sweep_change.translation().norm() < options_.segmenter_sigma &&
         frame.prior.mahalanobisDistance(frame.segmenter_motion->T_previous_current,
                                         options_.segmenter_sigma,
                                         options_.segmenter_sigma_rotation) < options_.gate;
}

Matrix6 MotionGate::segmenterInformation() const
{
  Matrix6 information =
      informationFromSigmas(options_.segmenter_sigma, options_.segmenter_sigma_rotation);
  // A segmenter in the bird's-eye view observes neither height nor tilt.
  information.diagonal().segment<3>(2).setZero();
  return information;
}

/** A matcher may follow surrounding traffic instead of the static world: its motion is accepted
 * only near the prior. */
std::string MotionGate::rejectionReason(const Frame& frame, const FrameContext& context) const
{
  if (!frame.odometry.registered())
  {
    return frame.odometry.reason;
  }
  if (!registers_)
  {
    return {};
  }
  if (context.starts_map && context.acceptedSegmenterMotion())
  {
    return "not needed: the first registration starts from the segmenter's motion";
  }
  const bool informed = frame.dt > 0 && context.matcher_uses_prior;
  const double distance = frame.prior.mahalanobisDistance(
      frame.odometry.T_previous_current,
      informed ? options_.informed_sigma : options_.matcher_sigma,
      informed ? options_.informed_sigma_rotation : options_.matcher_sigma_rotation);
  const double gate = informed ? options_.informed_gate : options_.gate;
  if (distance < gate)
  {
    return {};
  }
  return formatted("%.1f sigmas from the prior; the gate is %.1f", distance, gate);
}

/** A motion that already contains the prior is fused with it again: the more certain the prior, the
 * lower the weight of a matcher that may follow the traffic. */
Pose MotionGate::initialGuess(const Frame& frame, const FrameContext& context) const
{
  if (!frame.odometry_accepted)
  {
    return frame.prior.T_previous_current;
  }
  if (!registers_ || !context.matcher_uses_prior)
  {
    return frame.odometry.T_previous_current;
  }
  MotionPrior fused = frame.prior;
  fused.fuse(frame.odometry.T_previous_current,
             informationFromSigmas(options_.matcher_sigma, options_.matcher_sigma_rotation));
  return fused.T_previous_current;
}

double MotionGate::initialSigma(const Frame& frame, const FrameContext& context, double sigma) const
{
  if (context.acceptedSegmenterMotion())
  {
    sigma = std::min(sigma, options_.segmenter_initial_sigma);
  }
  if (frame.odometry_accepted && context.matcher_uses_prior)
  {
    sigma = std::min(sigma, options_.matcher_initial_sigma);
  }
  return sigma;
}
}  // namespace dyslam
