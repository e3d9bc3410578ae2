// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/StateArchive.h>
#include <dyslam/odometry/Odometry.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <utility>

#include "CloudCheck.h"
#include "OdometryState.h"

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

Odometry::Odometry(ConfigLoader& config, ThreadPool& pool, mrpt::system::CTimeLogger& times)
    : Odometry(config, pool, times, nullptr)
{
}
Odometry::Odometry(ConfigLoader& config,
                   ThreadPool& pool,
                   mrpt::system::CTimeLogger& times,
                   std::unique_ptr<ScanMatcher> matcher)
    : state_(std::make_unique<State>(config, pool, times, std::move(matcher)))
{
}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;

void Odometry::predict(Frame& frame)
{
  State& s = *state_;
  s.clock.advance(frame.scan.stamp);
  s.doubtful = s.clock.isDoubtful();
  s.after_gap = false;
  frame.sweep_duration = s.clock.sweepDuration();
  frame.dt = frame.sweep_duration;  // settleTime() corrects it
  frame.clock_offset = s.clock.offset();
  s.senseMotion(frame);
  frame.prior = s.priorAfter(frame.dt);
  s.fuseSensedMotion(frame.dt, frame.prior);
  frame.T_odom_vehicle = s.T_odom_previous * frame.prior.T_previous_current;
  s.started = true;
}

void Odometry::settleTime(Frame& frame, const std::function<Cloud(const Pose&, double)>& prepare)
{
  State& s = *state_;
  if (!s.doubtful)
  {
    s.clock.settle(s.clock.interval());
    return;
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  const std::optional<Pose> T_found = s.motionOverDoubtfulInterval(frame, prepare);
  const bool set = T_found
                       ? showsClockStep(s.filter, s.clock.interval(), s.clock.period(), *T_found)
                       : s.clock.interval() <= 0;
  frame.dt = set ? s.clock.period() : s.clock.interval();
  s.clock.settle(frame.dt);
  s.after_gap = frame.dt > ScanClock::max_extrapolation;
  frame.clock_offset = s.clock.offset();
  frame.prior = s.priorAfter(std::min(frame.dt, ScanClock::max_extrapolation));
  s.fuseSensedMotion(frame.dt, frame.prior);
  if (T_found && !set)
  {
    frame.prior.T_previous_current = *T_found;
  }
  frame.T_odom_vehicle = s.T_odom_previous * frame.prior.T_previous_current;
  // Beyond the extrapolation the prior covers a part of dt; the sweep is deskewed by its velocity.
  const double beyond = frame.dt / ScanClock::max_extrapolation;
  frame.cloud =
      prepare(s.after_gap && !T_found ? expSE3(beyond * logSE3(frame.prior.T_previous_current))
                                      : frame.prior.T_previous_current,
              frame.dt);
}

void Odometry::estimate(Frame& frame)
{
  State& s = *state_;
  {
    const CTimeLoggerEntry timed(s.times, "odometry");
    s.countSegmenterMotions(frame);
    s.fuseSegmenterMotion(frame);
    s.matchScan(frame);
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  const bool usable = reasonUnusable(frame).empty();
  s.without_scan += frame.dt;
  const bool extrapolates =
      usable || s.without_scan <= ScanClock::max_extrapolation || s.isDeadReckoned();
  const Pose T_guess = extrapolates ? s.initialGuess(frame) : Pose::Identity();
  if (s.registers())
  {
    s.registerToMap(frame, T_guess);
  }
  else
  {
    s.takeMatcherMotion(frame, T_guess);
  }
  s.without_scan = usable ? 0 : s.without_scan;
  s.T_odom_previous = frame.T_odom_vehicle;
  s.T_sweep_previous = frame.cloud.T_sweep;
}

void Odometry::integrate(const Frame& frame)
{
  State& s = *state_;
  const CTimeLoggerEntry timed(s.times, "refine");
  if (s.registers())
  {
    s.registration.commit(std::move(s.alignment), frame);
  }
}

void Odometry::exchangeState(StateArchive& archive)
{
  State& s = *state_;
  archive(s.filter, *s.matcher, s.registration, s.uncertainty, s.clock, s.started, s.registered,
          s.without_scan, s.mean_velocity, s.T_odom_previous, s.T_sweep_previous,
          s.segmenter_frames, s.segmenter_failures, s.sensors, s.moved, s.start_speed_sensed);
}

std::string Odometry::name() const
{
  std::string name = state_->matcher->name();
  switch (state_->refine.method)
  {
    case RefineMethod::none:
      break;
    case RefineMethod::point_to_plane:
      name += " + point_to_plane";
      break;
    case RefineMethod::gicp:
      name += " + gicp";
      break;
  }
  return name + state_->sensors.name();
}

std::vector<std::string> Odometry::warnings() const
{
  const State& s = *state_;
  std::vector<std::string> warnings;
  if (std::string of_clock = s.clock.warning(); !of_clock.empty())
  {
    warnings.push_back(std::move(of_clock));
  }
  for (std::string& of_sensor : s.sensors.warnings())
  {
    warnings.push_back(std::move(of_sensor));
  }
  if (!s.registers() && s.matcher->name() == "constant_velocity" && s.sensors.name().empty())
  {
    warnings.emplace_back(
        "nothing measures the motion: odometry.method=constant_velocity only predicts it, and "
        "refine.method is none; change one of them");
  }
  constexpr int min_frames = 4;
  if (!s.startSpeedKnown() && s.segmenter_frames >= min_frames &&
      2 * s.segmenter_failures >= s.segmenter_frames)
  {
    warnings.emplace_back(
        "the first scans do not determine the speed at the start of the recording; if it is known, "
        "set odometry.start_speed");
  }
  return warnings;
}
}  // namespace dyslam
