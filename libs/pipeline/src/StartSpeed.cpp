// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/StartSpeed.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "StartSearch.h"

namespace dyslam
{
namespace
{
/** Speed from which the run's own start is compared with that of the registration, which takes a
 * few tenths of a second [m/s]. */
constexpr double fast = 10;
/** Acceleration that explains a difference between the speeds at the start and later [m/s^2]. */
constexpr double usual_acceleration = 1;

/** The speed of later scans, unless the vehicle may have accelerated or the drifts of the first
 * scans contradict it. \param start of the run */
std::optional<double> speedOfLaterScans(StartSearch& search,
                                        const TimedSpeed& start,
                                        const std::vector<SpeedDrift>& drifts)
{
  const std::optional<TimedSpeed> later = search.laterSpeed();
  if (!later)
  {
    return std::nullopt;
  }
  const double explained =
      std::max(same_speed_of_runs, usual_acceleration * (later->stamp - start.stamp));
  const StartOptions& options = search.options();
  const bool contradicted = supportOf(drifts, start.speed, options) >=
                            supportOf(drifts, later->speed, options) + options.min_margin;
  return std::fabs(later->speed - start.speed) > explained && !contradicted
             ? std::optional(later->speed)
             : std::nullopt;
}
}  // namespace

void StartOptions::describe(OptionsVisitor& v)
{
  v.flag("search", search,
         "search for the speed at the first scan where the first scans do not determine it");
  v.integer("scans", scans, 3, 100, "number of first scans used in the search for the start speed");
  v.integer("look_ahead", look_ahead, 0, 1000,
            "number of further scans used where the first scans do not determine the speed");
  v.real("slowest", slowest, min_start_speed, 0, "lowest start speed that is tried [m/s]");
  v.real("fastest", fastest, 0, max_start_speed, "highest start speed that is tried [m/s]");
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
  const StartOptions& options = search.options();
  if (!search.isWanted() || !search.readTo(static_cast<std::size_t>(options.scans)) ||
      search.isMeasured())
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
  const TimedSpeed start = search.speedOfRun();
  if (is_determined)
  {
    // Between uniform rails the segmenter may lead the run away from the speed of the registration.
    return std::fabs(start.speed - registered) < same_speed_of_runs ? std::nullopt
                                                                    : std::optional(registered);
  }
  if (!isPossibleStart(start.speed) || search.isPulledTo(start.speed))
  {
    return std::nullopt;
  }
  const std::vector<SpeedDrift> drifts = search.drifts();
  if (const auto speed = speedOfDrifts(drifts, start.speed, options))
  {
    // The grid of speeds is coarse; the odometry refines the result.
    const double settled = search.speedAfter(*speed);
    return isPossibleStart(settled) && std::fabs(settled - *speed) < options.max_drift ? settled
                                                                                       : speed;
  }
  return speedOfLaterScans(search, start, drifts);
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
