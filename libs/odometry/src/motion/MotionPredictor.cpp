// SPDX-License-Identifier: BSD-3-Clause
#include "MotionPredictor.h"

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double velocity_share = 0.25;  // of a new velocity in the mean of the last ones
}  // namespace

MotionPredictor::MotionPredictor(const OdometryOptions& start,
                                 const MotionFilterOptions& motion,
                                 const MotionSensorOptions& sensors,
                                 double reliable_sigma)
    : start_(start),
      motion_(motion),
      reliable_sigma_(reliable_sigma),
      filter_(motion),
      sensors_(sensors)
{
  startFilter(start_.start_speed,
              startSpeedKnown() ? start_.start_speed_sigma : motion_.start_speed_sigma);
}

/** \param speed forward [m/s] \param sigma of the velocity [m/s] */
void MotionPredictor::startFilter(double speed, double sigma)
{
  Vector6 velocity = Vector6::Zero();
  velocity.x() = speed;
  filter_.start(velocity, sigma, motion_.start_turn_rate_sigma);
}

void MotionPredictor::predict(Frame& frame, FrameContext& context)
{
  clock_.advance(frame.scan.stamp);
  context.interval_doubtful = clock_.isDoubtful();
  frame.sweep_duration = clock_.sweepDuration();
  // correctInterval() corrects a doubtful one
  frame.dt = context.interval_doubtful ? frame.sweep_duration : clock_.interval();
  frame.clock_offset = clock_.offset();
  senseMotion(frame, context);
  frame.prior = priorAfter(frame.dt);
  context.sensed_information = fuseSensed(frame.dt, context, frame.prior);
  started_ = true;
}

/** Motion by the other sensors since the previous scan; a recording that begins in motion starts
 * with the speed of the wheels. */
void MotionPredictor::senseMotion(const Frame& frame, FrameContext& context)
{
  sensors_.add(frame);
  const double interval = clock_.interval();
  if (interval <= 0 || interval > ScanClock::max_extrapolation)
  {
    return;
  }
  const double before = frame.scan.stamp - interval;
  if (!moved_ && !startSpeedKnown())
  {
    if (const auto speed = sensors_.speedAt(before))
    {
      startFilter(*speed, start_.start_speed_sigma);
      start_speed_sensed_ = true;
    }
  }
  moved_ = true;
  context.sensed = sensors_.sense(before, frame.scan.stamp, filter_.predict(interval));
}

void MotionPredictor::acceptInterval()
{
  clock_.settle(clock_.interval());
}

void MotionPredictor::correctInterval(double dt, Frame& frame, FrameContext& context)
{
  clock_.settle(dt);
  context.after_gap = dt > ScanClock::max_extrapolation;
  frame.dt = dt;
  frame.clock_offset = clock_.offset();
  frame.prior = priorAfter(std::min(dt, ScanClock::max_extrapolation));
  context.sensed_information = fuseSensed(dt, context, frame.prior);
}

MotionPrior MotionPredictor::priorAfter(double dt) const
{
  MotionPrior prior;
  prior.T_previous_current = filter_.predict(dt);
  prior.information = filter_.information(dt);
  prior.reliable = started_ && (startSpeedKnown() || filter_.sigma(dt) < reliable_sigma_);
  return prior;
}

Matrix6 MotionPredictor::fuseSensed(double dt,
                                    const FrameContext& context,
                                    MotionPrior& prior) const
{
  if (context.sensed && dt == clock_.interval())
  {
    return sensors_.fuse(*context.sensed, prior);
  }
  return Matrix6::Zero();
}

std::optional<MotionPrior> MotionPredictor::meanVelocityPrior(const Frame& frame,
                                                              const FrameContext& context) const
{
  if (!mean_velocity_ || context.after_gap)
  {
    return std::nullopt;
  }
  MotionPrior steady = frame.prior;
  steady.T_previous_current =
      context.sensedPart(frame.prior.T_previous_current, frame.dt * *mean_velocity_);
  return steady;
}

std::optional<MotionPrior> MotionPredictor::priorOtherwise(const Frame& frame,
                                                           const FrameContext& context,
                                                           Matrix6& sensed_information) const
{
  if (!context.sensed || frame.dt != clock_.interval())
  {
    return std::nullopt;
  }
  MotionPrior prior = priorAfter(frame.dt);
  const auto sensed = sensors_.senseOtherwise(frame.scan.stamp - frame.dt, frame.scan.stamp,
                                              prior.T_previous_current);
  if (!sensed)
  {
    return std::nullopt;
  }
  sensed_information = sensors_.fuse(*sensed, prior);
  if (context.acceptedSegmenterMotion())
  {
    prior.fuse(frame.segmenter_motion->T_previous_current, context.segmenter_information);
  }
  return prior;
}

void MotionPredictor::update(const Frame& frame,
                             const FrameContext& context,
                             const RegistrationResult& registration)
{
  const MotionEstimate& motion = registration.motion;
  if (context.after_gap || !context.canExtrapolate())
  {
    filter_.forget(std::max(frame.dt, context.time_without_scan));
  }
  else
  {
    const Vector6 root = registration.prior_weight.cwiseSqrt();
    filter_.update(frame.dt, motion.T_previous_current,
                   registration.measured_information + context.segmenter_information +
                       Matrix6(root.asDiagonal() * context.sensed_information * root.asDiagonal()),
                   registration.prior_weight);
  }
  if (frame.dt == clock_.interval() && registration.points > 0 && motion.converged())
  {
    if (context.sensed)
    {
      sensors_.compare(*context.sensed, context.sensed_information, frame.dt,
                       motion.T_previous_current, registration.measured_information);
    }
    sensors_.compareClocks(frame.scan.stamp - frame.dt, frame.scan.stamp,
                           motion.T_previous_current);
  }
  if (frame.dt > 0 && motion.registered() && !context.after_gap)
  {
    const Vector6 velocity = logSE3(motion.T_previous_current) / frame.dt;
    mean_velocity_ = mean_velocity_
                         ? Vector6(*mean_velocity_ + velocity_share * (velocity - *mean_velocity_))
                         : velocity;
  }
}

void MotionPredictor::updateUnregistered(const Frame& frame,
                                         const FrameContext& context,
                                         const Pose& T_previous_current)
{
  if (context.after_gap)
  {
    filter_.forget(frame.dt);
    return;
  }
  if (!context.matcher_uses_prior)
  {
    filter_.follow(frame.dt, T_previous_current);
    return;
  }
  const Matrix6 measured =
      frame.odometry_accepted ? frame.odometry.information : Matrix6(Matrix6::Zero());
  filter_.update(frame.dt, T_previous_current,
                 measured + context.segmenter_information + context.sensed_information);
}

bool MotionPredictor::showsClockStep(const Pose& T_previous_current) const
{
  return dyslam::showsClockStep(filter_, clock_.interval(), clock_.period(), T_previous_current);
}

std::vector<std::string> MotionPredictor::warnings() const
{
  std::vector<std::string> warnings = clock_.warnings();
  for (std::string& of_sensor : sensors_.warnings())
  {
    warnings.push_back(std::move(of_sensor));
  }
  return warnings;
}
}  // namespace dyslam
