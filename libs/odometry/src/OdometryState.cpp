// SPDX-License-Identifier: BSD-3-Clause
#include "OdometryState.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

namespace dyslam
{
Odometry::State::State(ConfigLoader& config,
                       ThreadPool& pool,
                       mrpt::system::CTimeLogger& time_logger,
                       std::unique_ptr<ScanMatcher> given)
    : times(time_logger),
      options(config.get<OdometryOptions>("odometry")),
      fusion(config.get<FusionOptions>("fusion")),
      motion(config.get<MotionFilterOptions>("motion")),
      refine(config.get<RefineOptions>("refine")),
      matcher(given ? std::move(given) : makeScanMatcher(options.method, config, pool)),
      registration(refine, pool),
      predictor(options,
                motion,
                config.get<MotionSensorOptions>("motion_sensors"),
                fusion.reliable_prior_sigma),
      uncertainty(config.get<UncertaintyOptions>("uncertainty"))
{
}

void Odometry::State::countSegmenterMotions(const Frame& frame)
{
  if (frame.dt > 0 && !frame.static_prior.empty())
  {
    ++history.segmenter_frames;
    history.segmenter_failures += frame.segmenter_motion ? 0 : 1;
  }
}

/** The segmenter's ego-motion is used as long as it has an appearance prior: estimated from static
 * classes, it is not biased by surrounding traffic. Two scans that were deskewed by different
 * motions do not determine the motion between them. */
bool Odometry::State::acceptsSegmenterMotion(const Frame& frame) const
{
  if (!frame.segmenter_motion || frame.static_prior.empty() || frame.dt <= 0 ||
      predictor.startSpeedKnown())
  {
    return false;
  }
  const Pose sweep_change = history.T_sweep_previous.inverse() * frame.cloud.T_sweep;
  return sweep_change.translation().norm() < fusion.segmenter_sigma &&
         frame.prior.mahalanobisDistance(frame.segmenter_motion->T_previous_current,
                                         fusion.segmenter_sigma,
                                         fusion.segmenter_sigma_angle) < fusion.gate;
}

void Odometry::State::fuseSegmenterMotion(Frame& frame)
{
  context.segmenter_information.setZero();
  if (acceptsSegmenterMotion(frame))
  {
    context.segmenter_information =
        informationFromSigmas(fusion.segmenter_sigma, fusion.segmenter_sigma_angle);
    // A segmenter in the bird's-eye view observes neither height nor tilt.
    context.segmenter_information.diagonal().segment<3>(2).setZero();
    frame.prior.fuse(frame.segmenter_motion->T_previous_current, context.segmenter_information);
  }
}

/** A matcher may follow surrounding traffic instead of the static world: its motion is accepted
 * only near the prior. \return why it is rejected; empty if it is accepted */
std::string Odometry::State::rejectionReason(const Frame& frame) const
{
  if (!frame.odometry.converged)
  {
    return frame.odometry.reason;
  }
  if (!registers())
  {
    return {};
  }
  if (startsMap() && context.acceptedSegmenterMotion())
  {
    return "the segmenter's motion is the initial guess of the first registration";
  }
  const bool informed = frame.dt > 0 && matcher->usesPrior();
  const double distance = frame.prior.mahalanobisDistance(
      frame.odometry.T_previous_current, informed ? fusion.informed_sigma : fusion.matcher_sigma,
      informed ? fusion.informed_sigma_angle : fusion.matcher_sigma_angle);
  const double gate = informed ? fusion.informed_gate : fusion.gate;
  if (distance < gate)
  {
    return {};
  }
  char text[80];
  std::snprintf(text, sizeof text, "%.1f sigmas from the prior; the gate is %.1f", distance, gate);
  return text;
}

void Odometry::State::matchScan(Frame& frame)
{
  ScanMatch match = matcher->match(frame, frame.prior);
  frame.odometry = std::move(match.motion);
  frame.odometry_rejection = rejectionReason(frame);
  frame.odometry_accepted = frame.odometry_rejection.empty();
  frame.static_confidence =
      frame.odometry_accepted ? std::move(match.static_confidence) : std::vector<float>();
  weightByAppearance(frame);
}

/** Until motion can be observed, points of movable appearance have zero weight. */
void Odometry::State::weightByAppearance(Frame& frame) const
{
  if (frame.static_prior.empty() || frame.static_prior.size() != frame.cloud.size())
  {
    return;
  }
  const auto least = static_cast<float>(fusion.min_static_prior);
  frame.static_confidence.resize(frame.cloud.size(), 1.0F);
  std::transform(frame.static_prior.begin(), frame.static_prior.end(),
                 frame.static_confidence.begin(), frame.static_confidence.begin(),
                 [least](float prior, float confidence)
                 { return prior < least ? 0.0F : confidence; });
}

/** The matcher's motion, if accepted; one that already contains the prior is fused with it again:
 * the more certain the prior, the lower the weight of a matcher that may follow the traffic. */
Pose Odometry::State::initialGuess(const Frame& frame) const
{
  if (!frame.odometry_accepted)
  {
    return frame.prior.T_previous_current;
  }
  if (!registers() || !matcher->usesPrior())
  {
    return frame.odometry.T_previous_current;
  }
  MotionPrior fused = frame.prior;
  fused.fuse(frame.odometry.T_previous_current,
             informationFromSigmas(fusion.matcher_sigma, fusion.matcher_sigma_angle));
  return fused.T_previous_current;
}

/** Sigma of the initial guess, if this is the first registration to a map [m]. */
double Odometry::State::initialSigma(const Frame& frame) const
{
  double sigma = refine.initial_sigma;
  if (!history.registered && predictor.startSpeedKnown())
  {
    sigma = std::min(sigma, options.start_speed_sigma * frame.dt);
  }
  if (context.acceptedSegmenterMotion())
  {
    sigma = std::min(sigma, fusion.segmenter_initial_sigma);
  }
  if (frame.odometry_accepted && matcher->usesPrior())
  {
    sigma = std::min(sigma, fusion.matcher_initial_sigma);
  }
  return sigma;
}

/** Registers from the guess and, if that fails, from the mean motion of the last scans, except for
 * what other sensors measured: after an abrupt motion, or one that was misjudged, the velocity of
 * the last scan alone may be wrong. */
RegistrationResult Odometry::State::registerFrom(const Frame& frame, const Pose& T_guess)
{
  const RegistrationResult result = registration.registerFrame(
      frame, history.T_odom_previous * T_guess, &frame.prior, initialSigma(frame));
  const bool failed = result.points > 0 && result.measured_information.isZero();
  const std::optional<MotionPrior> steady = failed && registration.framesInMap() >= 2
                                                ? predictor.meanVelocityPrior(frame, context)
                                                : std::nullopt;
  return steady ? registration.registerAgain(
                      frame, history.T_odom_previous * steady->T_previous_current, &*steady)
                : result;
}

void Odometry::State::registerToMap(Frame& frame, const Pose& T_guess)
{
  const RegistrationResult result = registerFrom(frame, T_guess);
  history.registered = history.registered || result.points > 0;
  frame.motion = result.motion;
  frame.T_odom_vehicle = result.T_odom_vehicle;
  predictor.update(frame, context, result);
  uncertainty.calibrate(frame.dt, result.measured_information, frame.motion);
}

void Odometry::State::takeMatcherMotion(Frame& frame, const Pose& T_guess)
{
  frame.motion = frame.odometry;
  uncertainty.calibrateMatch(frame.dt, frame.prior.information, frame.motion);
  frame.T_odom_vehicle = orthonormalized(history.T_odom_previous * T_guess);
  predictor.updateUnregistered(frame, context, T_guess, matcher->usesPrior());
}
}  // namespace dyslam
