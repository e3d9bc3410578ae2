// SPDX-License-Identifier: BSD-3-Clause
#include "OdometryState.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double clearly_better = 0.02;  // difference of inlier shares
constexpr double velocity_share = 0.25;  // of a new velocity in the mean of the last ones
}  // namespace

Odometry::State::State(ConfigLoader& config,
                       ThreadPool& pool,
                       mrpt::system::CTimeLogger& time_logger,
                       std::unique_ptr<ScanMatcher> given)
    : times(time_logger),
      options(config.get<OdometryOptions>("odometry")),
      fusion(config.get<FusionOptions>("fusion")),
      motion_options(config.get<MotionFilterOptions>("motion")),
      refine(config.get<RefineOptions>("refine")),
      filter(motion_options),
      matcher(given ? std::move(given) : makeScanMatcher(options.method, config, pool)),
      registration(refine, pool),
      sensors(config.get<MotionSensorOptions>("motion_sensors")),
      uncertainty(config.get<UncertaintyOptions>("uncertainty"))
{
  Vector6 velocity = Vector6::Zero();
  velocity.x() = options.start_speed;
  filter.start(velocity,
               startSpeedKnown() ? options.start_speed_sigma : motion_options.start_speed_sigma,
               motion_options.start_turn_rate_sigma);
}

void Odometry::State::countSegmenterMotions(const Frame& frame)
{
  if (frame.dt > 0 && !frame.static_prior.empty())
  {
    ++segmenter_frames;
    segmenter_failures += frame.segmenter_motion ? 0 : 1;
  }
}

/** The segmenter's ego-motion is used as long as it has an appearance prior: estimated from static
 * classes, it is not biased by surrounding traffic. Two scans that were deskewed by different
 * motions do not determine the motion between them. */
bool Odometry::State::acceptsSegmenterMotion(const Frame& frame) const
{
  if (!frame.segmenter_motion || frame.static_prior.empty() || frame.dt <= 0 || startSpeedKnown())
  {
    return false;
  }
  const Pose sweep_change = T_sweep_previous.inverse() * frame.cloud.T_sweep;
  return sweep_change.translation().norm() < fusion.segmenter_sigma &&
         frame.prior.mahalanobisDistance(frame.segmenter_motion->T_previous_current,
                                         fusion.segmenter_sigma,
                                         fusion.segmenter_sigma_rotation) < fusion.gate;
}

void Odometry::State::fuseSegmenterMotion(Frame& frame)
{
  segmenter_information.setZero();
  if (acceptsSegmenterMotion(frame))
  {
    segmenter_information =
        informationFromSigmas(fusion.segmenter_sigma, fusion.segmenter_sigma_rotation);
    // A segmenter in the bird's-eye view observes neither height nor tilt.
    segmenter_information.diagonal().segment<3>(2).setZero();
    frame.prior.fuse(frame.segmenter_motion->T_previous_current, segmenter_information);
  }
}

/** A matcher may follow surrounding traffic instead of the static world: its motion is accepted
 * only near the prior. \return why it is rejected; empty if it is accepted */
std::string Odometry::State::rejectionReason(const Frame& frame) const
{
  if (!frame.odometry.registered())
  {
    return frame.odometry.reason;
  }
  if (!registers())
  {
    return {};
  }
  if (startsMap() && !segmenter_information.isZero())
  {
    return "the segmenter's motion is the initial guess of the first registration";
  }
  const bool informed = frame.dt > 0 && matcher->usesPrior();
  const double distance = frame.prior.mahalanobisDistance(
      frame.odometry.T_previous_current, informed ? fusion.informed_sigma : fusion.matcher_sigma,
      informed ? fusion.informed_sigma_rotation : fusion.matcher_sigma_rotation);
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
             informationFromSigmas(fusion.matcher_sigma, fusion.matcher_sigma_rotation));
  return fused.T_previous_current;
}

/** Sigma of the initial guess, if this is the first registration to a map [m]. */
double Odometry::State::initialSigma(const Frame& frame) const
{
  double sigma = refine.initial_sigma;
  if (!registered && startSpeedKnown())
  {
    sigma = std::min(sigma, options.start_speed_sigma * frame.dt);
  }
  if (!segmenter_information.isZero())
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
LocalMapRegistration::Alignment Odometry::State::registerFrom(const Frame& frame,
                                                              const Pose& T_guess) const
{
  LocalMapRegistration::Alignment from_guess =
      registration.align(frame, T_odom_previous * T_guess, &frame.prior, initialSigma(frame));
  const RegistrationResult& result = from_guess.result();
  const bool failed = result.points > 0 && result.measured_information.isZero();
  if (!failed || !mean_velocity || after_gap || registration.framesInMap() < 2)
  {
    return from_guess;
  }
  MotionPrior steady = frame.prior;
  Vector6 step = frame.dt * *mean_velocity;
  const Vector6 of_prior = logSE3(frame.prior.T_previous_current);
  for (Eigen::Index i = 0; i < step.size(); ++i)
  {
    step[i] = sensed_information(i, i) > 0 ? of_prior[i] : step[i];
  }
  steady.T_previous_current = expSE3(step);
  return registration.align(frame, T_odom_previous * steady.T_previous_current, &steady);
}

void Odometry::State::updateMeanVelocity(const Frame& frame)
{
  if (frame.dt <= 0 || !frame.motion.registered() || after_gap)
  {
    return;
  }
  const Vector6 velocity = logSE3(frame.motion.T_previous_current) / frame.dt;
  mean_velocity = mean_velocity
                      ? Vector6(*mean_velocity + velocity_share * (velocity - *mean_velocity))
                      : velocity;
}

void Odometry::State::registerToMap(Frame& frame, const Pose& T_guess)
{
  alignment = registerFrom(frame, T_guess);
  const RegistrationResult& result = alignment.result();
  registered = registered || result.points > 0;
  frame.motion = result.motion;
  frame.T_odom_vehicle = result.T_odom_vehicle;
  if (after_gap || (without_scan > ScanClock::max_extrapolation && !isDeadReckoned()))
  {
    filter.forget(std::max(frame.dt, without_scan));
  }
  else
  {
    const Vector6 root = result.prior_weight.cwiseSqrt();
    filter.update(frame.dt, result.motion.T_previous_current,
                  result.measured_information + segmenter_information +
                      Matrix6(root.asDiagonal() * sensed_information * root.asDiagonal()),
                  result.prior_weight);
  }
  if (sensed && frame.dt == clock.interval() && result.points > 0 && frame.motion.converged())
  {
    sensors.compare(*sensed, sensed_information, frame.dt, frame.motion.T_previous_current,
                    result.measured_information);
  }
  updateMeanVelocity(frame);
  uncertainty.calibrate(frame.dt, result.measured_information, frame.motion);
}

void Odometry::State::takeMatcherMotion(Frame& frame, const Pose& T_guess)
{
  frame.motion = frame.odometry;
  uncertainty.calibrateMatch(frame.dt, frame.prior.information, frame.motion);
  frame.T_odom_vehicle = orthonormalized(T_odom_previous * T_guess);
  if (after_gap)
  {
    filter.forget(frame.dt);
    return;
  }
  if (!matcher->usesPrior())
  {
    filter.follow(frame.dt, T_guess);
    return;
  }
  const Matrix6 measured =
      frame.odometry_accepted ? frame.odometry.information : Matrix6(Matrix6::Zero());
  filter.update(frame.dt, T_guess, measured + segmenter_information + sensed_information);
}

MotionPrior Odometry::State::priorAfter(double dt) const
{
  MotionPrior prior;
  prior.T_previous_current = filter.predict(dt);
  prior.information = filter.information(dt);
  prior.reliable = started && (startSpeedKnown() || filter.sigma(dt) < fusion.reliable_prior_sigma);
  return prior;
}

/** Of a recording that begins in motion, by the wheels. \param stamp of the first scan */
void Odometry::State::startAtSensedSpeed(double stamp)
{
  const auto speed = sensors.speedAt(stamp);
  if (speed && !startSpeedKnown())
  {
    Vector6 velocity = Vector6::Zero();
    velocity.x() = *speed;
    filter.start(velocity, options.start_speed_sigma, motion_options.start_turn_rate_sigma);
    start_speed_sensed = true;
  }
}

/** By the other sensors, since the scan before. */
void Odometry::State::senseMotion(const Frame& frame)
{
  sensors.add(frame);
  const double interval = clock.interval();
  sensed.reset();
  if (interval <= 0 || interval > ScanClock::max_extrapolation)
  {
    return;
  }
  const double before = frame.scan.stamp - interval;
  if (!moved)
  {
    startAtSensedSpeed(before);
  }
  moved = true;
  sensed = sensors.sense(before, frame.scan.stamp, filter.predict(interval));
}

/** Nothing, if `dt` is not the time between the stamps. */
void Odometry::State::fuseSensedMotion(double dt, MotionPrior& prior)
{
  sensed_information.setZero();
  if (sensed && dt == clock.interval())
  {
    sensed_information = sensors.fuse(*sensed, prior);
  }
}

/** Motion since the scan before for an unknown interval: the initial guess that registers best, of
 * constant velocity for the interval, constant velocity for one period, and no motion. */
std::optional<Pose> Odometry::State::motionOverDoubtfulInterval(
    const Frame& frame, const std::function<Cloud(const Pose&, double)>& prepare)
{
  if (!registers() || registration.framesInMap() < 2)
  {
    return std::nullopt;
  }
  const double interval = clock.interval();
  std::vector<std::pair<double, MotionPrior>> starts;
  if (interval > 0 && interval <= ScanClock::max_extrapolation)
  {
    starts.emplace_back(interval, priorAfter(interval));
    fuseSensedMotion(interval, starts.back().second);
  }
  starts.emplace_back(clock.period(), priorAfter(clock.period()));
  if (interval > 0)
  {
    starts.emplace_back(interval, priorAfter(std::min(interval, ScanClock::max_extrapolation)));
    starts.back().second.T_previous_current = Pose::Identity();
  }
  Frame trial = frame;
  std::optional<Pose> T_best;
  double best = 0;
  for (const auto& [dt, prior] : starts)
  {
    trial.dt = dt;
    trial.prior = prior;
    trial.cloud = prepare(prior.T_previous_current, dt);
    const RegistrationResult found =
        registration.align(trial, T_odom_previous * prior.T_previous_current, &prior).result();
    if (found.motion.converged() && (!T_best || found.inlier_share > best + clearly_better))
    {
      T_best = found.motion.T_previous_current;
      best = found.inlier_share;
    }
  }
  return T_best;
}
}  // namespace dyslam
