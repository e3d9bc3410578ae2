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
#include <numeric>
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

bool StartSearch::readTo(std::size_t end)
{
  while (frames_.size() < end)
  {
    std::optional<Frame> frame = next_();
    if (!frame)
    {
      return false;
    }
    frames_.push_back(std::move(*frame));
    priors_.emplace_back();
  }
  return true;
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
  for (const Frame& frame : frames_)
  {
    sensors.add(frame);
  }
  return sensors.speedAt(frames_.front().scan.stamp).has_value();
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

/** Speed after `scans` scans by registration only. \param first scan with which the
 * odometry begins \param start speed there */
double StartSearch::speedAfter(std::size_t first, std::optional<double> start, int of_threads) const
{
  NoTimes times;
  const Config changed = startingAt(start);
  ConfigLoader loader(changed);
  ThreadPool pool(of_threads);
  Preprocessor preprocessor(loader.get<PreprocessOptions>("preprocess"), pool);
  Odometry odometry(loader, pool, times);
  double speed = 0;
  for (std::size_t i = first; i < first + static_cast<std::size_t>(options_.scans); ++i)
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
    speed = forwardSpeed(frame);
  }
  return speed;
}

/** Reads the first `end` scans and estimates their speeds and appearance priors as the run would.
 * \return whether the recording has them */
bool StartSearch::runTo(std::size_t end)
{
  if (!front_end_)
  {
    ConfigLoader loader(config_);
    front_end_ = std::make_unique<FrontEnd>(threads_, loader, times_);
  }
  if (!readTo(end))
  {
    return false;
  }
  while (speeds_.size() < end)
  {
    const std::size_t i = speeds_.size();
    Frame frame = frames_[i];
    front_end_->process(frame);
    speeds_.push_back(forwardSpeed(frame));
    if (!frame.static_prior.empty())
    {
      priors_[i].assign(frame.scan.size(), 1);
      for (std::size_t k = 0; k < frame.cloud.size(); ++k)
      {
        priors_[i][frame.cloud.source[k]] = frame.static_prior[k];
      }
    }
  }
  return true;
}

double StartSearch::speedAfter(std::optional<double> start) const
{
  return speedAfter(0, start, threads_);
}

/** Speeds after `scans` scans by registration only, started at several speeds. \param first scan
 * with which the odometry begins */
std::vector<double> StartSearch::speedsAfter(std::size_t first,
                                             const std::vector<double>& starts) const
{
  std::vector<double> after(starts.size());
  ThreadPool pool(threads_);
  pool.forChunks(starts.size(), 1,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     after[i] = speedAfter(first, starts[i], 1);
                   }
                 });
  return after;
}

bool StartSearch::isPulledTo(double speed) const
{
  const auto after = speedsAfter(0, {speed - probe_distance, speed + probe_distance});
  return std::all_of(after.begin(), after.end(),
                     [&](double probe) { return std::fabs(probe - speed) < same_speed; });
}

std::vector<SpeedDrift> StartSearch::drifts() const
{
  std::vector<double> starts;
  for (double speed = options_.slowest; speed <= options_.fastest; speed += options_.step)
  {
    starts.push_back(speed);
  }
  const std::vector<double> after = speedsAfter(0, starts);
  std::vector<SpeedDrift> result;
  for (std::size_t i = 0; i < starts.size(); ++i)
  {
    result.push_back({starts[i], after[i] - starts[i]});
  }
  return result;
}

TimedSpeed StartSearch::speedOfRun()
{
  const auto scans = static_cast<std::size_t>(options_.scans);
  runTo(scans);
  return {frames_[scans - 1].scan.stamp, speeds_[scans - 1]};
}

std::optional<TimedSpeed> StartSearch::laterSpeed()
{
  const auto scans = static_cast<std::size_t>(options_.scans);
  const auto look_ahead = static_cast<std::size_t>(options_.look_ahead);
  for (std::size_t first = scans; first <= look_ahead && runTo(first + scans); first += scans)
  {
    if (!isPossibleStart(speeds_[first]))
    {
      return std::nullopt;
    }
    const double run = speeds_[first + scans - 1];
    const auto after =
        speedsAfter(first, {speeds_[first] - probe_distance, speeds_[first] + probe_distance});
    if (std::all_of(after.begin(), after.end(),
                    [&](double probe) { return std::fabs(probe - run) < same_speed_of_runs; }))
    {
      const std::size_t averaged = (scans + 1) / 2;
      const auto end = speeds_.begin() + static_cast<std::ptrdiff_t>(first + scans);
      const double sum = std::accumulate(end - static_cast<std::ptrdiff_t>(averaged), end, 0.0);
      return TimedSpeed{frames_[first + scans - 1 - averaged / 2].scan.stamp,
                        sum / static_cast<double>(averaged)};
    }
  }
  return std::nullopt;
}

bool isPossibleStart(double speed)
{
  return speed >= min_start_speed + probe_distance && speed <= max_start_speed - probe_distance;
}

double knownSpeed(double speed)
{
  constexpr double standing = 1e-3;
  return std::fabs(speed) < standing ? standing : speed;
}
}  // namespace dyslam
