// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Motion.h>
#include <dyslam/odometry/MotionFilter.h>
#include <dyslam/odometry/ScanClock.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <stdexcept>
#include <vector>

namespace dyslam
{
namespace
{
constexpr std::size_t min_intervals = 5;  // least number of intervals that determine the rate
constexpr std::size_t max_intervals = 15;
constexpr double shortest = 0.75;  // shortest interval that fits the rate [periods]
constexpr double longest = 1.3;
constexpr double multiple_tolerance = 0.2;  // distance from a multiple of a period [periods]
constexpr std::size_t scans_per_gap = 10;   // missing scans are reported below this
constexpr std::size_t max_clock_steps = 3;  // more are reported as uneven stamps
constexpr double motion_gate = 3;           // largest Mahalanobis distance from the prediction
constexpr double margin = 1;  // Mahalanobis distance by which a period has to fit better
// Sigmas of a motion between scans by the registration.
constexpr double sigma = 0.03;         // [m]
constexpr double sigma_angle = 0.005;  // [rad]

/** The number of periods in an interval, where it is about a whole number of them; else 0. */
double multipleOf(double period, double interval)
{
  const double multiple = std::round(interval / period);
  return std::abs(interval - multiple * period) <= multiple_tolerance * period ? multiple : 0;
}

/** Whether every interval of one `unit` is short because a stamp is off: the interval before or
 * behind it is longer than `usual` by as much. The neighbours of the newest one, and of the oldest
 * one if there were some before, are not known. \param intervals in order of time */
bool unitsAreOffStamps(const std::deque<double>& intervals, double unit, double usual)
{
  if (unit >= shortest * usual)
  {
    return false;
  }
  const auto isPair = [&](std::size_t i)
  {
    const double sum = intervals[i] + intervals[i + 1];
    return std::abs(sum - 2 * usual) <= multiple_tolerance * usual;
  };
  const std::size_t newest = intervals.size() - 1;
  for (std::size_t i = intervals.size() < max_intervals ? 0 : 1; i < newest; ++i)
  {
    const bool is_off = isPair(i) || (i > 0 && isPair(i - 1));
    if (multipleOf(unit, intervals[i]) == 1 && !is_off)
    {
      return false;
    }
  }
  return true;
}

/** Mahalanobis distance of a motion from what the filter predicts for `dt`. */
double distanceAfter(const MotionFilter& filter, double dt, const Pose& T_previous_current)
{
  MotionPrior prior;
  prior.T_previous_current = filter.predict(dt);
  prior.information = filter.information(dt);
  return prior.mahalanobisDistance(T_previous_current, sigma, sigma_angle);
}
}  // namespace

void ScanClock::advance(double stamp)
{
  if (!std::isfinite(stamp))
  {
    throw std::invalid_argument("ScanClock: the stamp of a scan is not finite");
  }
  interval_ = started_ ? stamp - stamp_ : 0;
  started_ = true;
  stamp_ = stamp;
  ++scans_;
}

bool ScanClock::fitsRate() const
{
  if (scans_ > 1 && interval_ <= 0)
  {
    return false;
  }
  if (regular_.size() < min_intervals)
  {
    return scans_ <= 1 || scans_ > min_intervals + 1 || interval_ <= max_extrapolation;
  }
  const double expected = period();
  return interval_ >= shortest * expected && interval_ <= longest * expected;
}

bool ScanClock::isDoubtful() const
{
  const double expected = period();
  return !fitsRate() && !(scansAreMissing() && std::any_of(regular_.begin(), regular_.end(),
                                                           [&](double passed) {
                                                             return std::abs(interval_ - passed) <=
                                                                    multiple_tolerance * expected;
                                                           }));
}

/** Whether the last intervals are multiples of the shortest one, and not all once. A single short
 * interval among equal ones, or among many, is no sign of it, nor are short ones beside longer
 * ones: their stamps are off. */
bool ScanClock::scansAreMissing() const
{
  constexpr std::size_t many = 8;
  if (regular_.size() < min_intervals)
  {
    return false;
  }
  std::vector<double> sorted(regular_.begin(), regular_.end());
  std::sort(sorted.begin(), sorted.end());
  const double unit = sorted.front();
  const double second = multipleOf(unit, sorted[1]);
  const double most = multipleOf(unit, sorted.back());
  const bool unit_recurs = second == 1 || (sorted.size() < many && second < most);
  return most > 1 && unit_recurs && !unitsAreOffStamps(regular_, unit, sorted[sorted.size() / 2]) &&
         std::all_of(sorted.begin(), sorted.end(),
                     [unit](double passed) { return multipleOf(unit, passed) > 0; });
}

double ScanClock::period() const
{
  if (regular_.empty())
  {
    return 0;
  }
  std::vector<double> intervals(regular_.begin(), regular_.end());
  if (scansAreMissing())
  {
    const double unit = *std::min_element(intervals.begin(), intervals.end());
    for (double& interval : intervals)
    {
      interval /= multipleOf(unit, interval);
    }
  }
  return upperMedian(intervals);
}

void ScanClock::settle(double passed)
{
  const double step = interval_ - passed;
  if (step != 0)
  {
    offset_ += step;
    first_step_ = steps_ == 0 ? scans_ - 1 : first_step_;
    ++steps_;
    largest_step_ = std::abs(step) > std::abs(largest_step_) ? step : largest_step_;
  }
  else if (passed > 0 && passed <= max_extrapolation)
  {
    const double periods = regular_.size() < min_intervals ? 1 : multipleOf(period(), passed);
    if (periods > 1)
    {
      ++gaps_;
      missing_ += static_cast<std::size_t>(periods) - 1;
    }
    regular_.push_back(passed);
    if (regular_.size() > max_intervals)
    {
      regular_.pop_front();
    }
  }
}

double ScanClock::nextSweep(double stamp)
{
  advance(stamp);
  const double duration = sweepDuration();
  settle(interval_);
  return duration;
}

std::vector<std::string> ScanClock::warnings() const
{
  std::vector<std::string> warnings;
  if (steps_ > max_clock_steps)
  {
    warnings.push_back(formatted(
        "the time stamps are uneven: %zu intervals, the first before scan %zu, are off by "
        "up to %.3f s from what the vehicle's motion shows; the sensor's rate is used "
        "there",
        steps_, first_step_, std::abs(largest_step_)));
  }
  else if (steps_ > 0)
  {
    warnings.push_back(
        formatted("the clock of the recording was set before scan %zu%s, by %s%.3f s, while the "
                  "vehicle moved on; the motion there is by the sensor's rate, the stamps in the "
                  "results are the recording's",
                  first_step_, steps_ > 1 ? " and again later" : "", steps_ > 1 ? "up to " : "",
                  largest_step_));
  }
  if (gaps_ * scans_per_gap > scans_)
  {
    warnings.push_back("about " + std::to_string(missing_) + " of " +
                       counted(scans_ + missing_, "scan") +
                       " are missing, by the time stamps: results are better with all; check the "
                       "recorder and the conversion");
  }
  return warnings;
}

bool showsClockStep(const MotionFilter& filter,
                    double interval,
                    double period,
                    const Pose& T_previous_current)
{
  if (interval <= 0)
  {
    return true;
  }
  const double by_period = distanceAfter(filter, period, T_previous_current);
  if (by_period > motion_gate)
  {
    return false;
  }
  if (interval > ScanClock::max_extrapolation)
  {
    return distanceAfter(filter, period, Pose::Identity()) > motion_gate;  // not standing
  }
  return distanceAfter(filter, interval, T_previous_current) > by_period + margin;
}

void ScanClock::exchangeState(StateArchive& archive)
{
  archive(started_, stamp_, interval_, offset_, regular_, scans_, gaps_, missing_, steps_,
          first_step_, largest_step_);
}
}  // namespace dyslam
