// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/pipeline/StartSpeed.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "StartSearch.h"

namespace dyslam
{
namespace
{
/** Speed from which the run's own start is compared with that of the registration, which takes a
 * few tenths of a second [m/s]. */
constexpr double fast = 10;
/** Difference below which the speeds of two runs count as equal, where single motions swing between
 * rails [m/s]. */
constexpr double same_speed_of_runs = 1;
/** Difference from the odometry's own speed from which another one is reported [m/s]. */
constexpr double least_difference = 3;
/** Differences of the wheels' speed from that of the scans above which both contradict. */
constexpr double wheel_difference = 0.5;        //!< [m/s]
constexpr double wheel_difference_ratio = 0.3;  //!< share of the speed of the scans
/** Least ratio of the fit of the scans without the wheels to that with them: at least 1.9 with
 * speeds in km/h or backwards, up to 1.15 in jams, where the scans are wrong. */
constexpr double wheel_gain = 1.4;

/** The scans one after the other; `frames` outlives the result. */
NextScan scansOf(const std::vector<Frame>& frames)
{
  return [&frames, read = std::size_t(0)]() mutable
  { return read < frames.size() ? std::optional<Frame>(frames[read++]) : std::nullopt; };
}

bool contradict(const SpeedContradiction& speeds)
{
  return std::fabs(speeds.by_wheels - speeds.by_scans) >
         std::max(wheel_difference, wheel_difference_ratio * std::fabs(speeds.by_scans));
}

/** Compares starts at several speeds over more scans. \param own_speed the odometry's own [m/s]
 * \return as bestStartSpeed() */
std::optional<double> comparedSpeed(double own_speed, StartSearch& search)
{
  const StartOptions& options = search.options();
  search.readTo(static_cast<std::size_t>(options.compared_scans));
  std::vector<double> starts{own_speed};
  for (double speed = options.slowest; speed <= options.fastest; speed += options.step)
  {
    starts.push_back(speed);
  }
  const std::vector<StartRun> runs = search.runsFrom(starts);
  const auto best = bestStartSpeed(runs, runs.front(), own_speed, options);
  if (!best)
  {
    return std::nullopt;
  }
  // The grid of speeds is coarse; the odometry refines the result.
  const double settled = search.speedAfter(*best);
  return std::fabs(settled - *best) < options.step / 2 ? settled : *best;
}
}  // namespace

void StartOptions::describe(OptionsVisitor& v)
{
  v.flag("search", search,
         "search for the speed at the first scan where the first scans do not determine it");
  v.integer("scans", scans, 3, 100, "number of first scans that may determine the start speed");
  v.integer("compared_scans", compared_scans, 3, 1000,
            "number of first scans with which start speeds are compared where they do not");
  v.real("slowest", slowest, OdometryOptions::min_start_speed, 0,
         "lowest start speed that is tried [m/s]");
  v.real("fastest", fastest, 0, OdometryOptions::max_start_speed,
         "highest start speed that is tried [m/s]");
  v.real("step", step, 0.5, 20, "step between the start speeds that are tried [m/s]");
  v.real("sigma", sigma, 0.1, 20,
         "sigma of a start speed that is tried, and of the one found [m/s]");
  v.real("min_gain", min_gain, 0, 100,
         "least gain in the fit of the scans over the odometry's own start speed, as a share");
}

std::optional<double> bestStartSpeed(const std::vector<StartRun>& runs,
                                     const StartRun& own,
                                     double own_speed,
                                     const StartOptions& options)
{
  const StartRun* best = &own;
  for (const StartRun& run : runs)
  {
    if (isPossibleStart(run.speed) && run.fit > best->fit)
    {
      best = &run;
    }
  }
  const double from_own = std::fabs(best->speed - own_speed);
  if (std::fabs(best->speed - own.speed) < same_speed_of_runs)
  {
    // The odometry will find the speed, but at high speeds slowly.
    return best->speed >= fast && from_own >= same_speed_of_runs ? std::optional(best->speed)
                                                                 : std::nullopt;
  }
  const bool is_better = best->fit >= (1 + options.min_gain) * own.fit;
  return is_better && from_own >= least_difference ? std::optional(best->speed) : std::nullopt;
}

std::optional<double> findStartSpeed(const NextScan& next, const Config& config)
{
  StartSearch search(next, config);
  const auto scans = static_cast<std::size_t>(search.options().scans);
  if (!search.isWanted() || search.readTo(scans) < scans || search.isMeasured())
  {
    return std::nullopt;
  }
  const double registered = search.speedAfter(std::nullopt);
  if (!isPossibleStart(registered))
  {
    return std::nullopt;
  }
  const bool is_determined = search.isPulledTo(registered);
  if (is_determined && std::fabs(registered) < fast)
  {
    return std::nullopt;
  }
  const double own_speed = search.speedOfRun();
  if (is_determined)
  {
    // Between uniform rails the segmenter may lead the run away from the speed of the registration.
    return std::fabs(own_speed - registered) < same_speed_of_runs ? std::nullopt
                                                                  : std::optional(registered);
  }
  if (!isPossibleStart(own_speed) || search.isPulledTo(own_speed))
  {
    return std::nullopt;
  }
  return comparedSpeed(own_speed, search);
}

std::optional<double> findStartSpeed(const std::vector<Frame>& frames, const Config& config)
{
  return findStartSpeed(scansOf(frames), config);
}

std::optional<SpeedContradiction> findWheelContradiction(const NextScan& next, const Config& config)
{
  StartSearch with_wheels(next, config);
  const auto scans = static_cast<std::size_t>(with_wheels.options().scans);
  if (!with_wheels.isWanted() || with_wheels.readTo(2) < 2 || !with_wheels.isMeasured() ||
      with_wheels.readTo(scans) < scans)
  {
    return std::nullopt;
  }
  Config scans_alone = config;
  scans_alone.set("motion_sensors.wheel_odometry=false");
  const NextScan again = scansOf(with_wheels.frames());
  StartSearch without(again, scans_alone);
  without.readTo(scans);
  const std::optional<double> by_wheels = with_wheels.speedByWheels();
  const StartRun of_scans = without.run();
  const SpeedContradiction speeds{by_wheels.value_or(of_scans.speed), of_scans.speed};
  if (!contradict(speeds) || !isPossibleStart(of_scans.speed) ||
      !without.isPulledTo(of_scans.speed))
  {
    return std::nullopt;
  }
  const StartRun of_both = with_wheels.run();
  // Where the odometry rejects the wheels, it reports this itself.
  const bool follows_wheels = contradict({of_both.speed, of_scans.speed});
  return follows_wheels && of_scans.fit > wheel_gain * of_both.fit ? std::optional(speeds)
                                                                   : std::nullopt;
}

std::optional<SpeedContradiction> findWheelContradiction(const std::vector<Frame>& frames,
                                                         const Config& config)
{
  return findWheelContradiction(scansOf(frames), config);
}

std::string warningOf(const SpeedContradiction& contradiction, bool are_used)
{
  const std::string speeds = formatted(
      "it states %.1f m/s at the start of the recording, the scans show %.1f m/s: check "
      "its unit (m/s) and direction",
      contradiction.by_wheels, contradiction.by_scans);
  return are_used ? "the wheel odometry is used, though " + speeds
                  : "the wheel odometry is not used: " + speeds +
                        "; motion_sensors.wheel_odometry=true uses it, if it is right and most of "
                        "what the scans show is traffic";
}

void setStartSpeed(double speed, Config& config)
{
  StartOptions start;
  load(start, config, "start");
  const double rounded = std::round(10 * speed) / 10;
  config.set(formatted("odometry.start_speed=%g", knownSpeed(rounded)));
  config.set("odometry.start_speed_sigma=" + std::to_string(start.sigma));
}
}  // namespace dyslam
