// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PointTimes.h>
#include <dyslam/core/Rings.h>
#include <dyslam/formats/FieldConventions.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr double shortest_scan = 0.005;  //!< [s]
constexpr double longest_scan = 2;       //!< [s]

/** The least and the largest time that is known; both 0 if none is. */
struct TimeRange
{
  double first = 0;
  double last = 0;

  explicit TimeRange(const std::vector<double>& values)
  {
    constexpr double largest = 1e19;  // more than any time has in nanoseconds since 1970
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double least = infinity;
    double most = -infinity;
    for (const double value : values)
    {
      if (std::abs(value) < largest && value != 0)
      {
        least = std::min(least, value);
        most = std::max(most, value);
      }
    }
    if (least <= most)
    {
      first = least;
      last = most;
    }
  }
};

/** Unit [s] in which a scan whose times differ by `span` lasts 5 ms to 2 s; 0 if there is none. */
double unitOfSpan(double span)
{
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9})
  {
    if (span * unit >= shortest_scan && span * unit <= longest_scan)
    {
      return unit;
    }
  }
  return 0;
}

std::string nameOfUnit(double unit)
{
  return unit == 1      ? "seconds"
         : unit == 1e-3 ? "milliseconds"
         : unit == 1e-6 ? "microseconds"
                        : "nanoseconds";
}

/** \param zero [s] */
void appendTimes(
    const std::vector<double>& values, double unit, bool absolute, double zero, Scan& scan)
{
  scan.time.reserve(values.size());
  for (const double value : values)
  {
    const bool unknown = absolute && value == 0;
    scan.time.push_back(unknown ? std::numeric_limits<float>::quiet_NaN()
                                : static_cast<float>(value * unit - zero));
  }
}

/** The last ring of a lidar of which `last` is the highest ring with a return so far: of those with
 * a usual number of rings, if only a few are missing, as those that meet the sky or nothing within
 * range. */
std::uint16_t lastRingOf(std::uint16_t last)
{
  constexpr int part = 16;  // one in 16 rings may be missing
  const int seen = last + 1;
  for (const int rings : {16, 32, 40, 64, 80, 128})
  {
    if (seen <= rings && rings - seen <= rings / part)
    {
      return static_cast<std::uint16_t>(rings - 1);
    }
  }
  return last;
}
}  // namespace

double unitOfDate(double time)
{
  return time < 1e11 ? 1 : time < 1e14 ? 1e-3 : time < 1e17 ? 1e-6 : 1e-9;
}

void FieldConventions::toMetres(Scan& scan) const
{
  if (length_unit_ != 1)
  {
    for (Eigen::Vector3f& point : scan.points)
    {
      point *= static_cast<float>(length_unit_);
    }
  }
}

const std::string& FieldConventions::intensityField(const std::string& usual,
                                                    const std::string& calibrated,
                                                    const std::vector<double>& values)
{
  constexpr double limit = 255;
  if (intensity_field_.empty())
  {
    const bool exceeds =
        std::any_of(values.begin(), values.end(),
                    [](double value) { return std::isfinite(value) && value > limit; });
    intensity_field_ = exceeds && !calibrated.empty() ? calibrated : usual;
    note("intensity: field " + intensity_field_ + (exceeds ? ", limited to 255" : ""));
  }
  return intensity_field_;
}

/** Times since 1970 have the unit that makes a date of them, unless the scan then lasts too long:
 * the clock may count from the start of the lidar in a finer unit. All others have the unit in
 * which a scan lasts 5 ms to 2 s. */
FieldConventions::TimeScale FieldConventions::scaleOf(double first, double last, bool is_integer)
{
  constexpr double earliest_date = 9e8;  // [s since 1970], in 1998
  constexpr double latest_date = 4.1e9;  // [s since 1970], in 2099
  const double span = last - first;
  const double date_unit = unitOfDate(first);
  const double date = first * date_unit;
  if (date >= earliest_date && date <= latest_date && span * date_unit <= longest_scan)
  {
    return {date_unit, true, true};
  }
  const double span_unit = unitOfSpan(span);
  const double unit = span_unit != 0 ? span_unit : is_integer ? 1e-9 : 1.0;
  return {unit, std::abs(first) * unit > longest_scan, span_unit != 0};
}

void FieldConventions::setTimes(const std::string& field, double unit, bool absolute)
{
  scale_ = TimeScale{unit, absolute, true};
  note("per-point time: field " + field + ", " + nameOfUnit(unit) + " from the " +
       (absolute ? "clock's zero" : "time stamp"));
}

/** Determines unit and zero by the first scan that shows them. */
void FieldConventions::learnTimes(const TimeField& field)
{
  const TimeRange range(field.values);
  if (scale_ || times_unusable_ || !(range.last > range.first))
  {
    return;
  }
  // A float32 resolves one part in 2^24.
  if (field.is_float32 &&
      std::max(std::abs(range.first), std::abs(range.last)) > (range.last - range.first) * 1e5)
  {
    times_unusable_ = true;
    warn("field " + field.name + " is too coarse for the times of points (absolute, as float32)");
    return;
  }
  const TimeScale scale = scaleOf(range.first, range.last, field.is_integer);
  setTimes(field.name, scale.unit, scale.absolute);
  if (!scale.certain)
  {
    warn("field " + field.name + ": the first scan lasts 5 ms to 2 s in no unit; " +
         nameOfUnit(scale.unit) +
         " are assumed. If they are wrong, run dyslam with --set preprocess.deskew=none");
  }
}

/** Zero of absolute times: the stamp, or the first point if that has another clock. A stamp of the
 * same clock is that of a point, or of the message's arrival soon after the last one. \param first
 * time of a point [s] \param last time of a point [s] */
double FieldConventions::zeroOf(double first, double last, double stamp)
{
  constexpr double least_margin = 0.1;  // [s] that a driver or a network takes
  constexpr double other_clock = 1.0;   // [s] that no drift within a recording reaches
  const double margin = zero_ == Zero::unknown ? std::max(least_margin, last - first) : other_clock;
  if (zero_ != Zero::first_point && stamp >= first - margin && stamp <= last + margin)
  {
    zero_ = Zero::stamp;
    return stamp;
  }
  if (zero_ != Zero::first_point)
  {
    zero_ = Zero::first_point;
    warn("the points' clock is " + std::to_string(first - stamp) +
         " s from that of the time stamps; the first point of a scan gets its time stamp");
  }
  return first;
}

void FieldConventions::noteEqualTimes(const TimeField& field)
{
  if (!times_equal_)
  {
    warn("field " + field.name +
         " is the same for all points and not taken for their times, in the first scan at least");
  }
  times_equal_ = true;  // a later scan may show them
}

void FieldConventions::fillTimes(const TimeField& field, Scan& scan)
{
  learnTimes(field);
  if (times_unusable_)
  {
    return;
  }
  if (!scale_)
  {
    noteEqualTimes(field);
    return;
  }
  const TimeRange range(field.values);
  const double unit = scale_->unit;
  const bool any = range.first != 0;
  const double zero = !scale_->absolute ? 0
                      : any             ? zeroOf(range.first * unit, range.last * unit, scan.stamp)
                                        : scan.stamp;
  appendTimes(field.values, unit, scale_->absolute, zero, scan);
}

void FieldConventions::fillTimesAndStamp(const TimeField& field, Scan& scan)
{
  learnTimes(field);
  const TimeRange range(field.values);
  const TimeScale scale = scale_.value_or(scaleOf(range.first, range.last, field.is_integer));
  if (!scale_ && !times_unusable_ && scale.absolute && field.is_float32)
  {
    noteEqualTimes(field);
    return;
  }
  if (times_unusable_ || (scale.absolute && range.first == 0))
  {
    return;
  }
  if (scale.absolute)
  {
    scan.stamp = range.first * scale.unit;
  }
  appendTimes(field.values, scale.unit, scale.absolute, scan.stamp, scan);
}

void FieldConventions::restamp(Scan& scan, double stamp)
{
  if (scan.stamp != 0 && !scan.time.empty())
  {
    const auto last = static_cast<double>(timeExtent(scan.time).value_or(TimeExtent()).last);
    const double shift = scan.stamp - zeroOf(scan.stamp, scan.stamp + last, stamp);
    for (float& time : scan.time)
    {
      time = static_cast<float>(time + shift);
    }
  }
  scan.stamp = stamp;
}

void FieldConventions::orderRings(const std::string& source, Scan& scan, bool has_all)
{
  constexpr double least_returns = 16;  // fewer may be in any order by chance
  if (ring_order_ == Order::unknown)
  {
    double n = 0, sum_r = 0, sum_e = 0, sum_rr = 0, sum_ee = 0, sum_re = 0;
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      last_ring_ = std::max(last_ring_, scan.ring[i]);
      if (isReturn(scan.points[i]))
      {
        const double r = scan.ring[i];
        const double e = elevationOf(scan.points[i]);
        n += 1, sum_r += r, sum_e += e, sum_rr += r * r, sum_ee += e * e, sum_re += r * e;
      }
    }
    if (n < least_returns)
    {
      return;
    }
    // Reversed if ring and elevation have a correlation below -0.5; a Livox's lines have none.
    constexpr double min_correlation = 0.5;
    const double covariance = sum_re - sum_r * sum_e / n;  // both times n, which cancels out
    const double deviations =
        std::sqrt((sum_rr - sum_r * sum_r / n) * (sum_ee - sum_e * sum_e / n));
    ring_order_ =
        covariance < -min_correlation * deviations ? Order::from_highest : Order::from_lowest;
    last_ring_ = has_all ? last_ring_ : lastRingOf(last_ring_);
    note("ring: " + source +
         (ring_order_ == Order::from_highest ? ", reversed: 0 is the lowest" : ""));
  }
  if (ring_order_ == Order::from_highest)
  {
    for (std::uint16_t& ring : scan.ring)
    {
      ring = static_cast<std::uint16_t>(last_ring_ - std::min(ring, last_ring_));
    }
  }
}
}  // namespace dyslam
