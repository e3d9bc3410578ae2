// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/Odometry.h>
#include <mrpt/system/CTimeLogger.h>

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
  s.context = FrameContext();
  s.predictor.predict(frame, s.context);
  frame.T_odom_vehicle = s.history.T_odom_previous * frame.prior.T_previous_current;
}

void Odometry::settleTime(Frame& frame, const PrepareCloud& prepare)
{
  State& s = *state_;
  if (!s.context.interval_doubtful)
  {
    s.predictor.acceptInterval();
    return;
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  s.resolver.resolve(s.history.T_odom_previous, prepare, frame, s.context);
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
  s.context.time_without_scan = s.history.time_without_scan + frame.dt;
  const Pose T_guess =
      usable || s.context.canExtrapolate() ? s.initialGuess(frame) : Pose::Identity();
  if (s.registers())
  {
    s.registerToMap(frame, T_guess);
  }
  else
  {
    s.takeMatcherMotion(frame, T_guess);
  }
  s.history.time_without_scan = usable ? 0 : s.context.time_without_scan;
  s.history.T_odom_previous = frame.T_odom_vehicle;
  s.history.T_sweep_previous = frame.cloud.T_sweep;
}

void Odometry::integrate(const Frame& frame)
{
  const CTimeLoggerEntry timed(state_->times, "refine");
  state_->registration.integrate(frame);
}

void Odometry::exchangeState(StateArchive& archive)
{
  state_->exchangeState(archive);
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
  return name + state_->predictor.sensorNames();
}

std::vector<std::string> Odometry::warnings() const
{
  const State& s = *state_;
  std::vector<std::string> warnings = s.predictor.warnings();
  if (!s.registers() && s.matcher->name() == "constant_velocity" &&
      s.predictor.sensorNames().empty())
  {
    warnings.emplace_back(
        "nothing measures the motion: odometry.method=constant_velocity only predicts it, and "
        "refine.method is none; change one of them");
  }
  constexpr int min_frames = 4;
  if (!s.predictor.startSpeedKnown() && s.history.segmenter_frames >= min_frames &&
      2 * s.history.segmenter_failures >= s.history.segmenter_frames)
  {
    warnings.emplace_back(
        "the first scans do not determine the speed at the start of the recording; if it is known, "
        "set odometry.start_speed");
  }
  return warnings;
}
}  // namespace dyslam
