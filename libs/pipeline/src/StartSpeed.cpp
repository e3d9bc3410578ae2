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
#include <memory>
#include <numeric>
#include <string>
#include <utility>

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
/** The same for later scans, whose single motions swing between rails [m/s]. */
constexpr double same_later_speed = 1;
/** Acceleration that explains a difference between the speeds at the start and later [m/s^2]. */
constexpr double usual_acceleration = 1;
/** Speed from which the run's own start is compared with that of the registration, which takes a
 * few tenths of a second [m/s]. */
constexpr double fast = 10;
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

/** Speed at some time. */
struct TimedSpeed
{
  double stamp = 0;  //!< [s]
  double speed = 0;  //!< [m/s]
};

struct StartSearch
{
  StartSearch(const NextScan& next_scan, const Config& run_config)
      : next(next_scan), config(run_config)
  {
    ConfigLoader loader(config);
    options = loader.get<StartOptions>("start");
    threads = loader.get<PipelineOptions>("pipeline").threads;
  }

  bool readTo(std::size_t end);
  [[nodiscard]] bool isWanted() const;
  [[nodiscard]] bool isMeasured() const;
  [[nodiscard]] Config startingAt(std::optional<double> speed) const;
  [[nodiscard]] double speedAfter(std::size_t first,
                                  std::optional<double> start,
                                  int of_threads) const;
  [[nodiscard]] std::vector<double> speedsAfter(std::size_t first,
                                                const std::vector<double>& starts) const;
  bool runTo(std::size_t end);
  [[nodiscard]] bool isPulledTo(double speed) const;
  [[nodiscard]] std::vector<SpeedDrift> drifts() const;
  [[nodiscard]] std::optional<TimedSpeed> laterSpeed();

  const NextScan& next;
  const Config& config;
  StartOptions options;
  int threads = 0;
  NoTimes times;
  std::unique_ptr<FrontEnd> front_end;  //!< of the run from the first scan on
  std::vector<Frame> frames;            //!< first scans of the recording
  std::vector<double> speeds;           //!< speed at each scan that the run would estimate [m/s]
  StaticPriors priors;
};

/** Reads the first `end` scans. \return whether the recording has them */
bool StartSearch::readTo(std::size_t end)
{
  while (frames.size() < end)
  {
    std::optional<Frame> frame = next();
    if (!frame)
    {
      return false;
    }
    frames.push_back(std::move(*frame));
    priors.emplace_back();
  }
  return true;
}

/** Whether the run's settings leave the speed to be searched for. */
bool StartSearch::isWanted() const
{
  ConfigLoader loader(config);
  return options.search && loader.get<OdometryOptions>("odometry").start_speed == 0 &&
         loader.get<RefineOptions>("refine").method != RefineMethod::none;
}

/** Whether wheels measure the speed at the first scan. */
bool StartSearch::isMeasured() const
{
  ConfigLoader loader(config);
  MotionSensors sensors(loader.get<MotionSensorOptions>("motion_sensors"));
  for (const Frame& frame : frames)
  {
    sensors.add(frame);
  }
  return sensors.speedAt(frames.front().scan.stamp).has_value();
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

/** Speed after `options.scans` scans by registration only [m/s]. \param first scan with which the
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
  for (std::size_t i = first; i < first + static_cast<std::size_t>(options.scans); ++i)
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

/** Reads the first `end` scans and estimates their speeds and appearance priors as the run would.
 * \return whether the recording has them */
bool StartSearch::runTo(std::size_t end)
{
  if (!front_end)
  {
    ConfigLoader loader(config);
    front_end = std::make_unique<FrontEnd>(threads, loader, times);
  }
  if (!readTo(end))
  {
    return false;
  }
  while (speeds.size() < end)
  {
    const std::size_t i = speeds.size();
    Frame frame = frames[i];
    front_end->process(frame);
    speeds.push_back(forwardSpeed(frame));
    if (!frame.static_prior.empty())
    {
      priors[i].assign(frame.scan.size(), 1);
      for (std::size_t k = 0; k < frame.cloud.size(); ++k)
      {
        priors[i][frame.cloud.source[k]] = frame.static_prior[k];
      }
    }
  }
  return true;
}

std::vector<double> StartSearch::speedsAfter(std::size_t first,
                                             const std::vector<double>& starts) const
{
  std::vector<double> after(starts.size());
  ThreadPool pool(threads);
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

/** Whether a speed and the probes beside it are possible start speeds: false if the odometry
 * diverged or time stamps are wrong. */
bool isPlausible(double speed)
{
  return speed >= min_speed + probe_distance && speed <= max_speed - probe_distance;
}

/** Whether a lower and a higher initial speed both drift to a speed. */
bool StartSearch::isPulledTo(double speed) const
{
  const auto after = speedsAfter(0, {speed - probe_distance, speed + probe_distance});
  return std::all_of(after.begin(), after.end(),
                     [&](double probe) { return std::fabs(probe - speed) < same_speed; });
}

std::vector<SpeedDrift> StartSearch::drifts() const
{
  std::vector<double> starts;
  for (double speed = options.slowest; speed <= options.fastest; speed += options.step)
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

/** Speed of the run at the first later scans that determine it: starts beside its speed end where
 * it does. */
std::optional<TimedSpeed> StartSearch::laterSpeed()
{
  const auto scans = static_cast<std::size_t>(options.scans);
  const auto look_ahead = static_cast<std::size_t>(options.look_ahead);
  for (std::size_t first = scans; first <= look_ahead && runTo(first + scans); first += scans)
  {
    if (!isPlausible(speeds[first]))
    {
      return std::nullopt;
    }
    const double run = speeds[first + scans - 1];
    const auto after =
        speedsAfter(first, {speeds[first] - probe_distance, speeds[first] + probe_distance});
    if (std::all_of(after.begin(), after.end(),
                    [&](double probe) { return std::fabs(probe - run) < same_later_speed; }))
    {
      const std::size_t averaged = (scans + 1) / 2;
      const auto end = speeds.begin() + static_cast<std::ptrdiff_t>(first + scans);
      const double sum = std::accumulate(end - static_cast<std::ptrdiff_t>(averaged), end, 0.0);
      return TimedSpeed{frames[first + scans - 1 - averaged / 2].scan.stamp,
                        sum / static_cast<double>(averaged)};
    }
  }
  return std::nullopt;
}

}  // namespace

void StartOptions::describe(OptionsVisitor& v)
{
  v.flag("search", search,
         "search for the speed at the first scan where the first scans do not determine it");
  v.integer("scans", scans, 3, 100, "number of first scans used in the search for the start speed");
  v.integer("look_ahead", look_ahead, 0, 1000,
            "number of further scans used where the first scans do not determine the speed");
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

std::optional<double> findStartSpeed(const NextScan& next, const Config& config)
{
  StartSearch search(next, config);
  if (!search.isWanted() || !search.readTo(static_cast<std::size_t>(search.options.scans)) ||
      search.isMeasured())
  {
    return std::nullopt;
  }
  const double registered = search.speedAfter(0, std::nullopt, search.threads);
  if (!isPlausible(registered))
  {
    return std::nullopt;
  }
  const bool determined = search.isPulledTo(registered);
  if (determined && std::fabs(registered) < fast)
  {
    return std::nullopt;
  }
  search.runTo(search.frames.size());
  const double start = search.speeds.back();
  if (determined)
  {
    // Between uniform rails the segmenter may lead the run away from the speed of the registration.
    return std::fabs(start - registered) < same_later_speed ? std::nullopt
                                                            : std::optional(registered);
  }
  if (!isPlausible(start) || search.isPulledTo(start))
  {
    return std::nullopt;
  }
  const std::vector<SpeedDrift> drifts = search.drifts();
  if (const auto speed = speedOfDrifts(drifts, start, search.options))
  {
    // The grid of speeds is coarse; the odometry refines the result.
    const double settled = search.speedAfter(0, *speed, search.threads);
    return isPlausible(settled) && std::fabs(settled - *speed) < search.options.max_drift ? settled
                                                                                          : speed;
  }
  const double stamp = search.frames.back().scan.stamp;  // laterSpeed() reads more
  const auto later = search.laterSpeed();
  if (!later)
  {
    return std::nullopt;
  }
  // Later scans decide, unless the vehicle may have accelerated or the drifts contradict them.
  const double explained = std::max(same_later_speed, usual_acceleration * (later->stamp - stamp));
  const auto support = [&](double speed) { return supportOf(drifts, speed, search.options); };
  return std::fabs(later->speed - start) > explained &&
                 support(start) < support(later->speed) + search.options.min_margin
             ? std::optional(later->speed)
             : std::nullopt;
}

std::optional<double> findStartSpeed(const std::vector<Frame>& frames, const Config& config)
{
  std::size_t read = 0;
  const auto next = [&]
  { return read < frames.size() ? std::optional<Frame>(frames[read++]) : std::nullopt; };
  return findStartSpeed(next, config);
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
