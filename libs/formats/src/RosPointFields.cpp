// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "RosCloud2.h"

namespace dyslam
{
namespace
{
constexpr double near_header = 1.0;  //!< [s] between absolute times of points and the header's

double elevation(const Eigen::Vector3f& point)
{
  return std::atan2(point.z(), std::hypot(point.x(), point.y()));
}
}  // namespace

/** Ouster's `intensity` counts photons without limit; its `reflectivity` is calibrated. */
void RosScanDecoder::fillIntensity(const Cloud2& cloud, Scan& scan)
{
  const PointField* field = cloud.find({"intensity", "reflectivity", "i"});
  const PointField* calibrated = cloud.find({"reflectivity"});
  if (field == nullptr || scan.points.empty())
  {
    return;
  }
  if (intensity_field_.empty())
  {
    double largest = 0;
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      const double value = cloud.value(*field, i);
      largest = std::isfinite(value) ? std::max(largest, value) : largest;
    }
    intensity_field_ = largest > 255 && calibrated != nullptr ? calibrated->name : field->name;
    notes_.push_back("intensity: field " + intensity_field_ +
                     (largest > 255 ? ", limited to 255" : ""));
  }
  field = cloud.find({intensity_field_.c_str()});
  if (field == nullptr)
  {
    throw UserError(cloud.place + ": lacks the field " + intensity_field_ +
                    " that earlier scans have");
  }
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    scan.intensity.push_back(static_cast<float>(std::min(cloud.value(*field, i), 255.0)));
  }
}

void RosScanDecoder::noteTimes(const std::string& field, double seconds_per_unit, bool absolute)
{
  seconds_per_unit_ = seconds_per_unit;
  times_absolute_ = absolute;
  const std::string unit = seconds_per_unit == 1      ? "seconds"
                           : seconds_per_unit == 1e-3 ? "milliseconds"
                           : seconds_per_unit == 1e-6 ? "microseconds"
                                                      : "nanoseconds";
  notes_.push_back("per-point time: field " + field + ", " + unit + " from the " +
                   (absolute ? "clock's zero" : "time stamp"));
}

/** \param span of the times of a scan, in their unit: a scan takes between 5 ms and 2 s. */
double RosScanDecoder::unitOf(double span, bool whole)
{
  constexpr double shortest = 0.005;
  constexpr double longest = 2;
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9})
  {
    if (span * unit >= shortest && span * unit <= longest)
    {
      return unit;
    }
  }
  return whole ? 1e-9 : 1.0;
}

/** Determines the unit of the time field, by the first scan that shows it. */
void RosScanDecoder::learnTimes(const std::string& field,
                                bool whole,
                                bool coarse,
                                const std::vector<double>& values)
{
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const double value : values)
  {
    if (std::isfinite(value) && value != 0)
    {
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  if (!(most > least))
  {
    if (!times_equal_)
    {
      warnings_.push_back("field " + field +
                          " is the same for all points and not taken for their times, in the first "
                          "scan at least");
    }
    times_equal_ = true;  // a later scan may show them
    return;
  }
  // A float32 resolves one part in 2^24.
  if (coarse && std::max(std::abs(least), std::abs(most)) > (most - least) * 1e5)
  {
    times_unusable_ = true;
    warnings_.push_back("field " + field +
                        " is too coarse for the times of points (absolute, as float32)");
    return;
  }
  const double unit = unitOf(most - least, whole);
  constexpr double largest_relative = 10;  // [s]
  noteTimes(field, unit, std::abs(least) * unit > largest_relative);
}

const PointField* RosScanDecoder::timeField(const Cloud2& cloud)
{
  return cloud.find({"t", "time", "timestamp", "offset_time", "time_offset", "time_stamp"});
}

const PointField* RosScanDecoder::ringField(const Cloud2& cloud)
{
  return cloud.find({"ring", "line", "channel", "laser_id"});
}

void RosScanDecoder::fillTimes(const Cloud2& cloud, Scan& scan)
{
  const PointField* field = timeField(cloud);
  if (field == nullptr || times_unusable_ || scan.points.empty())
  {
    return;
  }
  std::vector<double> values(scan.size());
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = cloud.value(*field, i);
  }
  if (seconds_per_unit_ == 0)
  {
    constexpr std::uint8_t float32 = 7;
    learnTimes(field->name, field->isWhole(), field->type == float32, values);
    if (seconds_per_unit_ == 0)
    {
      return;
    }
  }
  double zero = 0;
  if (times_absolute_)
  {
    zero = zeroOf(values, cloud.header.stamp);
  }
  scan.time.reserve(values.size());
  for (const double value : values)
  {
    const bool unknown = times_absolute_ && value == 0;
    scan.time.push_back(unknown ? std::numeric_limits<float>::quiet_NaN()
                                : static_cast<float>(value * seconds_per_unit_ - zero));
  }
}

/** Origin of absolute times: the stamp, or the first point if that has another clock. */
double RosScanDecoder::zeroOf(const std::vector<double>& values, double stamp)
{
  double earliest = std::numeric_limits<double>::infinity();
  for (const double value : values)
  {
    earliest = std::isfinite(value) && value != 0 ? std::min(earliest, value) : earliest;
  }
  earliest *= seconds_per_unit_;
  if (!std::isfinite(earliest) || std::abs(earliest - stamp) <= near_header)
  {
    return stamp;
  }
  if (!clocks_differ_)
  {
    clocks_differ_ = true;
    warnings_.push_back("the points' clock is " + std::to_string(earliest - stamp) +
                        " s from that of the headers; the first point gets the time of the header");
  }
  return earliest;
}

void RosScanDecoder::fillRings(const Cloud2& cloud, Scan& scan)
{
  constexpr std::uint32_t most_rows = 256;
  const PointField* field = ringField(cloud);
  const bool rows = cloud.height > 1 && cloud.height <= most_rows && cloud.width > cloud.height;
  if ((field == nullptr && !rows) || scan.points.empty())
  {
    return;
  }
  scan.ring.reserve(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const double ring =
        field != nullptr ? cloud.value(*field, i) : static_cast<double>(i / cloud.width);
    scan.ring.push_back(static_cast<std::uint16_t>(ring > 0 ? std::min(ring, 65535.0) : 0.0));
  }
  orderRings(field != nullptr ? "field " + field->name : "rows of the cloud", scan);
}

void RosScanDecoder::orderRings(const std::string& source, Scan& scan)
{
  if (ring_order_ == Order::unknown)
  {
    double n = 0, sum_r = 0, sum_e = 0, sum_rr = 0, sum_ee = 0, sum_re = 0;
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      last_ring_ = std::max(last_ring_, scan.ring[i]);
      if (isReturn(scan.points[i]))
      {
        const double r = scan.ring[i];
        const double e = elevation(scan.points[i]);
        n += 1, sum_r += r, sum_e += e, sum_rr += r * r, sum_ee += e * e, sum_re += r * e;
      }
    }
    if (n < 2)
    {
      return;
    }
    const double covariance = sum_re - sum_r * sum_e / n;
    const double spread = std::sqrt((sum_rr - sum_r * sum_r / n) * (sum_ee - sum_e * sum_e / n));
    constexpr double clear = 0.5;  // a Livox's lines have no order by height
    ring_order_ = covariance < -clear * spread ? Order::from_highest : Order::from_lowest;
    notes_.push_back("ring: " + source +
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
