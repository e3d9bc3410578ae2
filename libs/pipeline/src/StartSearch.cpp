// SPDX-License-Identifier: BSD-3-Clause
#include "StartSearch.h"

#include <dyslam/base/Parallel.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/RefineOptions.h>
#include <dyslam/pipeline/Pipeline.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace dyslam
{
namespace
{
/** Difference below which two speeds of the registration count as equal [m/s]. */
constexpr double same_speed = 0.3;
/** Distance of a probe speed, which may drift back to the odometry's speed [m/s]. */
constexpr double probe_distance = 5;

/** Forward speed along the last motion [m/s]. */
double forwardSpeed(const Frame& frame)
{
  return frame.dt > 0 ? frame.motion.T_previous_current.translation().x() / frame.dt : 0;
}
}  // namespace

StartSearch::StartSearch(const NextScan& next, const Config& config) : next_(next), config_(config)
{
  ConfigLoader loader(config_);
  options_ = loader.get<StartOptions>("start");
  threads_ = loader.get<PipelineOptions>("pipeline").threads;
}

std::size_t StartSearch::readTo(std::size_t end)
{
  while (frames_.size() < end)
  {
    std::optional<Frame> frame = next_();
    if (!frame)
    {
      break;
    }
    frames_.push_back(std::move(*frame));
    priors_.emplace_back();
  }
  return frames_.size();
}

bool StartSearch::isWanted() const
{
  ConfigLoader loader(config_);
  return options_.search && loader.get<OdometryOptions>("odometry").start_speed == 0 &&
         loader.get<RefineOptions>("refine").method != RefineMethod::none;
}

bool StartSearch::isMeasured() const
{
  ConfigLoader loader(config_);
  MotionSensors sensors(loader.get<MotionSensorOptions>("motion_sensors"));
  // The odometry looks for the speed at the second scan; later samples come too late for it.
  sensors.add(frames_.at(0));
  sensors.add(frames_.at(1));
  return sensors.speedAt(frames_.front().scan.stamp).has_value();
}

std::optional<double> StartSearch::speedByWheels() const
{
  ConfigLoader loader(config_);
  MotionSensors sensors(loader.get<MotionSensorOptions>("motion_sensors"));
  for (const Frame& frame : frames_)
  {
    sensors.add(frame);
  }
  return sensors.speedAt(frames_.back().scan.stamp);
}

StartRun StartSearch::run() const
{
  return runFrom(std::nullopt, frames_.size(), threads_);
}

Config StartSearch::startingAt(std::optional<double> speed) const
{
  Config changed = config_;
  if (speed)
  {
    changed.set("odometry.start_speed=" + std::to_string(knownSpeed(*speed)));
    changed.set("odometry.start_speed_sigma=" + std::to_string(options_.sigma));
  }
  return changed;
}

/** A run of the registration over the first `scans` scans. \param start speed at the first one */
StartRun StartSearch::runFrom(std::optional<double> start, std::size_t scans, int of_threads) const
{
  mrpt::system::CTimeLogger times(false);
  const Config changed = startingAt(start);
  ConfigLoader loader(changed);
  ThreadPool pool(of_threads);
  Preprocessor preprocessor(loader.get<PreprocessOptions>("preprocess"), pool);
  Odometry odometry(loader, pool, times);
  StartRun run;
  FitMean fit;
  for (std::size_t i = 0; i < scans; ++i)
  {
    Frame frame = frames_[i];
    const auto prepare = [&](const Pose& T_previous_current, double dt)
    { return preprocessor.prepare(frame.scan, T_previous_current, dt, frame.sweep_duration); };
    odometry.predict(frame);
    frame.cloud = prepare(frame.prior.T_previous_current, frame.dt);
    odometry.resolveInterval(frame, prepare);
    if (!priors_[i].empty())
    {
      for (const std::uint32_t point : frame.cloud.source)
      {
        frame.static_prior.push_back(priors_[i][point]);
      }
    }
    odometry.estimate(frame);
    odometry.integrate(frame);
    if (i < static_cast<std::size_t>(options_.scans))
    {
      run.speed = forwardSpeed(frame);
    }
    if (2 * i >= scans)  // before, the local map has few scans
    {
      fit.add(frame.motion, frame.cloud.size());
    }
  }
  run.fit = fit.value();
  return run;
}

std::vector<StartRun> StartSearch::runsFrom(const std::vector<double>& starts,
                                            std::size_t scans) const
{
  std::vector<StartRun> runs(starts.size());
  ThreadPool pool(threads_);
  pool.forChunks(starts.size(), 1,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     runs[i] = runFrom(starts[i], scans, 1);
                   }
                 });
  return runs;
}

std::vector<StartRun> StartSearch::runsFrom(const std::vector<double>& starts)
{
  // Segmenters give appearance priors for the first scans only.
  while (front_end_ && gives_priors_ && processed_ < frames_.size())
  {
    processNext();
  }
  return runsFrom(starts, frames_.size());
}

double StartSearch::speedAfter(std::optional<double> start) const
{
  return runFrom(start, static_cast<std::size_t>(options_.scans), threads_).speed;
}

bool StartSearch::isPulledTo(double speed) const
{
  const auto runs = runsFrom({speed - probe_distance, speed + probe_distance},
                             static_cast<std::size_t>(options_.scans));
  return std::all_of(runs.begin(), runs.end(),
                     [&](const StartRun& run)
                     { return std::fabs(run.speed - speed) < same_speed; });
}

double StartSearch::speedOfRun()
{
  ConfigLoader loader(config_);
  front_end_ = std::make_unique<FrontEnd>(threads_, loader, times_);
  while (processed_ < frames_.size())
  {
    processNext();
  }
  return speed_of_run_;
}

void StartSearch::processNext()
{
  Frame frame = frames_[processed_];
  front_end_->process(frame);
  speed_of_run_ = forwardSpeed(frame);
  gives_priors_ = frame.cloud.size() == 0 ? gives_priors_ : !frame.static_prior.empty();
  if (!frame.static_prior.empty())
  {
    std::vector<float>& prior = priors_[processed_];
    prior.assign(frame.scan.size(), 1);
    for (std::size_t k = 0; k < frame.cloud.size(); ++k)
    {
      prior[frame.cloud.source[k]] = frame.static_prior[k];
    }
  }
  ++processed_;
}

void FitMean::add(const MotionEstimate& motion, std::size_t points)
{
  ++scans_;
  inlier_share_ +=
      static_cast<double>(motion.inliers) / static_cast<double>(std::max<std::size_t>(1, points));
  if (motion.inliers > 0)
  {
    ++with_inliers_;
    rmse_ += motion.rmse;
  }
}

double FitMean::value() const
{
  constexpr double least_rmse = 1e-3;  // [m]
  if (with_inliers_ == 0)
  {
    return 0;
  }
  const double rmse = std::max(least_rmse, rmse_ / with_inliers_);
  return inlier_share_ / scans_ / (rmse * rmse);
}

bool isPossibleStart(double speed)
{
  return speed >= OdometryOptions::min_start_speed + probe_distance &&
         speed <= OdometryOptions::max_start_speed - probe_distance;
}

double knownSpeed(double speed)
{
  constexpr double standing = 1e-3;
  return std::fabs(speed) < standing ? standing : speed;
}
}  // namespace dyslam
