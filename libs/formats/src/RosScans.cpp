// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RosMessages.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "RosReader.h"

namespace dyslam
{
namespace
{
constexpr double near_header = 1.0;  //!< [s] between absolute times of points and the header's

struct PointField
{
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t type = 0;  //!< 1 int8, 2 uint8, 3 int16, ... 7 float32, 8 float64

  [[nodiscard]] std::size_t size() const
  {
    constexpr std::array<std::size_t, 9> sizes{0, 1, 1, 2, 2, 4, 4, 4, 8};
    return type < sizes.size() ? sizes[type] : 0;
  }
  [[nodiscard]] bool isWhole() const { return type < 7; }
};

template <typename T>
double numberAt(const char* at)
{
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

bool isLivoxMessage(const std::string& type)
{
  return type == "livox_ros_driver/CustomMsg" || type == "livox_ros_driver2/CustomMsg";
}

double elevation(const Eigen::Vector3f& point)
{
  return std::atan2(point.z(), std::hypot(point.x(), point.y()));
}
}  // namespace

struct RosScanDecoder::Cloud2
{
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::string_view data;
  std::string place;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(width) * height; }

  [[nodiscard]] const PointField* find(std::initializer_list<const char*> names) const
  {
    for (const char* name : names)
    {
      for (const PointField& field : fields)
      {
        if (field.name == name && field.size() > 0)
        {
          return &field;
        }
      }
    }
    return nullptr;
  }

  [[nodiscard]] double value(const PointField& field, std::size_t point) const
  {
    const char* at =
        data.data() + point / width * row_step + point % width * point_step + field.offset;
    switch (field.type)
    {
      case 1:
        return numberAt<std::int8_t>(at);
      case 2:
        return numberAt<std::uint8_t>(at);
      case 3:
        return numberAt<std::int16_t>(at);
      case 4:
        return numberAt<std::uint16_t>(at);
      case 5:
        return numberAt<std::int32_t>(at);
      case 6:
        return numberAt<std::uint32_t>(at);
      case 7:
        return numberAt<float>(at);
      default:
        return numberAt<double>(at);
    }
  }

  static Cloud2 read(ByteReader reader, RosEncoding encoding);
  void check(const ByteReader& reader) const;
};

RosScanDecoder::Cloud2 RosScanDecoder::Cloud2::read(ByteReader reader, RosEncoding encoding)
{
  Cloud2 cloud;
  cloud.place = reader.place();
  cloud.header = rosHeader(reader, encoding);
  cloud.height = reader.u32();
  cloud.width = reader.u32();
  const std::uint32_t fields = reader.u32();
  for (std::uint32_t i = 0; i < fields; ++i)  // each takes bytes: no count outruns the message
  {
    PointField field;
    field.name = rosString(reader);
    field.offset = reader.u32();
    field.type = reader.u8();
    (void)reader.u32();  // count
    cloud.fields.push_back(field);
  }
  const bool big_endian = reader.u8() != 0;
  cloud.point_step = reader.u32();
  cloud.row_step = reader.u32();
  cloud.data = reader.block();
  if (big_endian)
  {
    reader.fail("has big-endian points, which are not read");
  }
  cloud.check(reader);
  return cloud;
}

void RosScanDecoder::Cloud2::check(const ByteReader& reader) const
{
  for (const PointField& field : fields)
  {
    if (static_cast<std::uint64_t>(field.offset) + field.size() > point_step)
    {
      reader.fail("damaged: field " + field.name + " lies outside of a point");
    }
  }
  if (size() > 0 && static_cast<std::uint64_t>(height - 1) * row_step +
                            static_cast<std::uint64_t>(width) * point_step >
                        data.size())
  {
    reader.fail("damaged: announces " + std::to_string(width) + " x " + std::to_string(height) +
                " points of " + std::to_string(point_step) + " bytes, but has " +
                std::to_string(data.size()) + " bytes");
  }
}

bool RosScanDecoder::reads(const BagTopic& topic)
{
  return topic.encoding != RosEncoding::other &&
         (topic.type == "sensor_msgs/PointCloud2" || isLivoxMessage(topic.type));
}

Scan RosScanDecoder::decode(const BagTopic& topic, const BagMessage& message)
{
  Scan scan =
      isLivoxMessage(topic.type) ? decodeLivox(topic, message) : decodeCloud(topic, message);
  if (scan.stamp == 0)
  {
    if (first_)
    {
      warnings_.push_back(topic.name +
                          ": its headers have no time stamp; the times of recording are used");
    }
    scan.stamp = message.recorded;
  }
  first_ = first_ && scan.points.empty();
  return scan;
}

Scan RosScanDecoder::decodeCloud(const BagTopic& topic, const BagMessage& message)
{
  const Cloud2 cloud = Cloud2::read(rosReader(topic, message), topic.encoding);
  const PointField* x = cloud.find({"x"});
  const PointField* y = cloud.find({"y"});
  const PointField* z = cloud.find({"z"});
  if (x == nullptr || y == nullptr || z == nullptr)
  {
    throw UserError(cloud.place + ": has no fields x, y and z");
  }
  Scan scan;
  scan.stamp = cloud.header.stamp;
  scan.points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    scan.points.emplace_back(static_cast<float>(cloud.value(*x, i)),
                             static_cast<float>(cloud.value(*y, i)),
                             static_cast<float>(cloud.value(*z, i)));
  }
  fillIntensity(cloud, scan);
  fillTimes(cloud, scan);
  fillRings(cloud, scan);
  return scan;
}

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

/** Finds out what the field of the times counts in, by the first scan that shows it. */
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
    times_unusable_ = true;
    warnings_.push_back("field " + field +
                        " is the same for all points: there is no per-point time");
    return;
  }
  // A float32 resolves one part in 2^24.
  if (coarse && std::max(std::abs(least), std::abs(most)) > (most - least) * 1e5)
  {
    times_unusable_ = true;
    warnings_.push_back("field " + field +
                        " is too coarse (absolute times as float32): there is no per-point time");
    return;
  }
  const double unit = unitOf(most - least, whole);
  constexpr double largest_relative = 10;  // [s]
  noteTimes(field, unit, std::abs(least) * unit > largest_relative);
}

void RosScanDecoder::fillTimes(const Cloud2& cloud, Scan& scan)
{
  const PointField* field =
      cloud.find({"t", "time", "timestamp", "offset_time", "time_offset", "time_stamp"});
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

/** What absolute times count from: the stamp, or the first point if that has another clock. */
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
  const PointField* field = cloud.find({"ring", "line", "channel", "laser_id"});
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
    scan.ring.push_back(static_cast<std::uint16_t>(std::clamp(ring, 0.0, 65535.0)));
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
                     (ring_order_ == Order::from_highest ? ", turned over: 0 is the lowest" : ""));
  }
  if (ring_order_ == Order::from_highest)
  {
    for (std::uint16_t& ring : scan.ring)
    {
      ring = static_cast<std::uint16_t>(last_ring_ - std::min(ring, last_ring_));
    }
  }
}

Scan RosScanDecoder::decodeLivox(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  Scan scan;
  scan.stamp = rosHeader(reader, topic.encoding).stamp;
  (void)reader.u64();  // time base: the stamp in nanoseconds
  (void)reader.u32();  // number of points, given again below
  (void)reader.u32();  // number of the lidar, and three reserved bytes
  const std::uint32_t count = reader.u32();
  constexpr std::size_t smallest_point = 19;
  if (count > (reader.left() + smallest_point - 1) / smallest_point)
  {
    reader.fail("damaged: announces " + std::to_string(count) + " points, but has " +
                std::to_string(reader.left()) + " bytes for them");
  }
  for (std::uint32_t i = 0; i < count; ++i)
  {
    scan.time.push_back(1e-9F * static_cast<float>(reader.u32()));
    const auto x = reader.number<float>();
    const auto y = reader.number<float>();
    scan.points.emplace_back(x, y, reader.number<float>());
    scan.intensity.push_back(reader.u8());
    (void)reader.u8();  // tag: what the driver thinks of the return
    scan.ring.push_back(reader.u8());
  }
  if (first_ && count > 0)
  {
    noteTimes("offset_time", 1e-9, false);
    notes_.emplace_back("ring: field line");
  }
  return scan;
}
}  // namespace dyslam
