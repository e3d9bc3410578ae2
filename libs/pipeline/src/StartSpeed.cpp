// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Parallel.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/RefineOptions.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace dyslam
{
namespace
{
/** A time logger that is not used. */
struct NoTimes : mrpt::system::CTimeLogger
{
  NoTimes() : CTimeLogger(false, "start") {}
};

/** Difference below which two speeds count as equal [m/s]. */
constexpr double same_speed = 0.3;
/** Distance of a probe speed, which may drift back to the odometry's speed [m/s]. */
constexpr double probe_distance = 5;
/** Limits of odometry.start_speed [m/s]. */
constexpr double min_speed = -50;
constexpr double max_speed = 100;

/** Frame::static_prior per frame and point of its scan; empty if the segmenter gives none. */
using StaticPriors = std::vector<std::vector<float>>;

/** A speed for odometry.start_speed [m/s], where zero would mean unknown. */
double knownSpeed(double speed)
{
  constexpr double standing = 1e-3;
  return std::fabs(speed) < standing ? standing : speed;
}

struct StartSearch
{
  StartSearch(const std::vector<Frame>& first_frames, const Config& run_config)
      : frames(first_frames), config(run_config), priors(frames.size())
  {
    ConfigLoader loader(config);
    options = loader.get<StartOptions>("start");
    threads = loader.get<PipelineOptions>("pipeline").threads;
  }

  [[nodiscard]] bool isWanted() const;
  [[nodiscard]] Config startingAt(std::optional<double> speed) const;
  [[nodiscard]] double speedAfter(std::optional<double> start, int of_threads) const;
  [[nodiscard]] std::vector<double> speedsAfter(const std::vector<double>& starts) const;
  [[nodiscard]] double speedOfFrontEnd();
  [[nodiscard]] bool isPulledTo(double speed) const;
  [[nodiscard]] std::vector<SpeedDrift> drifts() const;

  const std::vector<Frame>& frames;
  const Config& config;
  StartOptions options;
  int threads = 0;
  StaticPriors priors;
};

bool StartSearch::isWanted() const
{
  ConfigLoader loader(config);
  MotionSensors sensors(loader.get<MotionSensorOptions>("motion_sensors"));
  for (const Frame& frame : frames)
  {
    sensors.add(frame);
  }
  const bool sensed = !frames.empty() && sensors.speedAt(frames.front().scan.stamp);
  return options.search && !sensed && loader.get<OdometryOptions>("odometry").start_speed == 0 &&
         loader.get<RefineOptions>("refine").method != RefineMethod::none &&
         static_cast<int>(frames.size()) >= options.scans;
}

Config StartSearch::startingAt(std::optional<double> speed) const
{
  Config changed = config;
  if (speed)
  {
    changed.set("odometry.start_speed=" + std::to_string(knownSpeed(*speed)));
    changed.set("odometry.start_speed_sigma=" + std::to_string(options.sigma));
  }
  return changed;
}

/** Forward speed along the last motion [m/s]. */
double forwardSpeed(const Frame& frame)
{
  return frame.dt > 0 ? frame.motion.T_previous_current.translation().x() / frame.dt : 0;
}

/** Speed at the last frame by registration only, started at a given speed [m/s]. */
double StartSearch::speedAfter(std::optional<double> start, int of_threads) const
{
  NoTimes times;
  const Config changed = startingAt(start);
  ConfigLoader loader(changed);
  ThreadPool pool(of_threads);
  Preprocessor preprocessor(loader.get<PreprocessOptions>("preprocess"), pool);
  Odometry odometry(loader, pool, times);
  double speed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    Frame frame = frames[i];
    const auto prepare = [&](const Pose& T_previous_current, double dt)
    { return preprocessor.prepare(frame.scan, T_previous_current, dt, frame.sweep_duration); };
    odometry.predict(frame);
    frame.cloud = prepare(frame.prior.T_previous_current, frame.dt);
    odometry.resolveInterval(frame, prepare);
    if (!priors[i].empty())
    {
      for (const std::uint32_t point : frame.cloud.source)
      {
        frame.static_prior.push_back(priors[i][point]);
      }
    }
    odometry.estimate(frame);
    odometry.integrate(frame);
    speed = forwardSpeed(frame);
  }
  return speed;
}

/** Speed at the last frame that the run would estimate [m/s]; stores the appearance priors. */
double StartSearch::speedOfFrontEnd()
{
  NoTimes times;
  ConfigLoader loader(config);
  FrontEnd front_end(threads, loader, times);
  double speed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    Frame frame = frames[i];
    front_end.process(frame);
    speed = forwardSpeed(frame);
    if (!frame.static_prior.empty())
    {
      priors[i].assign(frame.scan.size(), 1);
      for (std::size_t k = 0; k < frame.cloud.size(); ++k)
      {
        priors[i][frame.cloud.source[k]] = frame.static_prior[k];
      }
    }
  }
  return speed;
}

std::vector<double> StartSearch::speedsAfter(const std::vector<double>& starts) const
{
  std::vector<double> speeds(starts.size());
  ThreadPool pool(threads);
  pool.forChunks(starts.size(), 1,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     speeds[i] = speedAfter(starts[i], 1);
                   }
                 });
  return speeds;
}

/** Whether a speed and the probes beside it are possible start speeds: false if the odometry
 * diverged or time stamps are wrong. */
bool isPlausible(double speed)
{
  return speed >= min_speed + probe_distance && speed <= max_speed - probe_distance;
}

/** Whether a lower and a higher initial speed both drift to a speed. */
bool StartSearch::isPulledTo(double speed) const
{
  const auto speeds = speedsAfter({speed - probe_distance, speed + probe_distance});
  return std::all_of(speeds.begin(), speeds.end(),
                     [&](double after) { return std::fabs(after - speed) < same_speed; });
}

std::vector<SpeedDrift> StartSearch::drifts() const
{
  std::vector<double> starts;
  for (double speed = options.slowest; speed <= options.fastest; speed += options.step)
  {
    starts.push_back(speed);
  }
  const std::vector<double> speeds = speedsAfter(starts);
  std::vector<SpeedDrift> result;
  for (std::size_t i = 0; i < starts.size(); ++i)
  {
    result.push_back({starts[i], speeds[i] - starts[i]});
  }
  return result;
}

}  // namespace

void StartOptions::describe(OptionsVisitor& v)
{
  v.flag("search", search,
         "search for the speed at the first scan where the first scans do not determine it");
  v.integer("scans", scans, 3, 100, "number of first scans used in the search for the start speed");
  v.real("slowest", slowest, min_speed, 0, "lowest start speed that is tried [m/s]");
  v.real("fastest", fastest, 0, max_speed, "highest start speed that is tried [m/s]");
  v.real("step", step, 0.5, 20, "step between the start speeds that are tried [m/s]");
  v.real("sigma", sigma, 0.1, 20,
         "sigma of a start speed that is tried, and of the one found [m/s]");
  v.real("max_drift", max_drift, 0.1, 100,
         "limit to which the drift of a tried speed over the first scans is clamped [m/s]");
  v.real("min_margin", min_margin, 0, 1e6,
         "least support (integral of drift over speed) beyond that of the odometry's own speed "
         "[m^2/s^2]");
}

std::optional<double> findStartSpeed(const std::vector<Frame>& frames, const Config& config)
{
  StartSearch search(frames, config);
  if (!search.isWanted())
  {
    return std::nullopt;
  }
  const double registered = search.speedAfter(std::nullopt, search.threads);
  if (!isPlausible(registered) || search.isPulledTo(registered))
  {
    return std::nullopt;
  }
  const double start = search.speedOfFrontEnd();
  if (!isPlausible(start) || search.isPulledTo(start))
  {
    return std::nullopt;
  }
  const auto speed = speedOfDrifts(search.drifts(), start, search.options);
  if (!speed)
  {
    return std::nullopt;
  }
  // The grid of speeds is coarse; the odometry refines the result.
  const double settled = search.speedAfter(*speed, search.threads);
  return isPlausible(settled) && std::fabs(settled - *speed) < search.options.max_drift ? settled
                                                                                        : speed;
}

void setStartSpeed(double speed, Config& config)
{
  StartOptions start;
  load(start, config, "start");
  const double rounded = std::round(10 * speed) / 10;
  char text[40];
  std::snprintf(text, sizeof text, "%g", knownSpeed(rounded));
  config.set(std::string("odometry.start_speed=") + text);
  config.set("odometry.start_speed_sigma=" + std::to_string(start.sigma));
}
}  // namespace dyslam
