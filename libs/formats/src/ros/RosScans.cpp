// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>

#include <algorithm>
#include <cmath>

#include "RosCloud2.h"

namespace dyslam
{
namespace
{
bool isLivoxMessage(const std::string& type)
{
  return type == "livox_ros_driver/CustomMsg" || type == "livox_ros_driver2/CustomMsg" ||
         type == "livox_interfaces/CustomMsg";
}
}  // namespace

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
    field.type = rosPointType(reader.u8());
    (void)reader.u32();  // count
    cloud.fields.push_back(field);
  }
  cloud.is_big_endian = reader.u8() != 0;
  cloud.point_step = reader.u32();
  cloud.row_step = reader.u32();
  cloud.data = reader.block();
  if (cloud.hasNoGaps())
  {
    cloud.row_step = cloud.width * cloud.point_step;  // that of some drivers is wrong
  }
  cloud.check(reader);
  cloud.checkByteOrder();
  return cloud;
}

void RosScanDecoder::Cloud2::checkByteOrder()
{
  const PointField* x = find("x");
  if (!is_big_endian || x == nullptr)
  {
    return;
  }
  const auto plausible = [&]
  {
    const std::vector<double> coordinates = values(*x);
    return std::count_if(coordinates.begin(), coordinates.end(),
                         [](double value)
                         { return std::abs(value) > 1e-6 && std::abs(value) < 1e6; });
  };
  const auto as_stated = plausible();
  is_big_endian = false;
  is_big_endian = as_stated >= plausible();
}

void RosScanDecoder::Cloud2::check(const ByteReader& reader) const
{
  if (size() == 0)
  {
    return;  // some drivers leave everything empty then
  }
  for (const PointField& field : fields)
  {
    const std::size_t size = field.type ? field.type->size : 0;
    if (static_cast<std::uint64_t>(field.offset) + size > point_step)
    {
      reader.fail("damaged: field " + field.name + " lies outside of a point");
    }
  }
  if (height > 1 && row_step < static_cast<std::uint64_t>(width) * point_step)
  {
    reader.fail("damaged: rows of " + counted(row_step, "byte") + " do not hold " +
                counted(width, "point") + " of " + std::to_string(point_step));
  }
  if (static_cast<std::uint64_t>(height - 1) * row_step +
          static_cast<std::uint64_t>(width) * point_step >
      data.size())
  {
    reader.fail("damaged: announces " + std::to_string(width) + " x " + std::to_string(height) +
                " points of " + counted(point_step, "byte") + ", but has " +
                counted(data.size(), "byte"));
  }
}

void RosScanDecoder::Cloud2::requireNearOrigin(const PointField& field) const
{
  if (field.type->kind != CloudNumber::Kind::floating || field.type->size != 8)
  {
    return;
  }
  // A few may be marked as invalid by their distance.
  std::vector<double> coordinates = values(field);
  coordinates.erase(std::remove_if(coordinates.begin(), coordinates.end(),
                                   [](double value) { return !std::isfinite(value); }),
                    coordinates.end());
  const double middle = coordinates.empty() ? 0 : upperMedian(coordinates);
  if (std::abs(middle) > farthest_coordinate)
  {
    failTooFar(middle, place);
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
  first_ = first_ && scan.points.empty();
  return scan;
}

double RosScanDecoder::stampOf(const RosHeader& header,
                               const BagTopic& topic,
                               const BagMessage& message,
                               std::size_t points)
{
  if (header.stamp != 0 || points == 0 || begins_at_zero_)
  {
    return header.stamp;
  }
  if (first_)
  {
    conventions_.warn(topic.name +
                      ": its headers have no time stamp; the times of recording are used");
  }
  return message.recorded;
}

/** Some drivers publish the scans of several lidars on one topic. */
void RosScanDecoder::checkFrame(const RosHeader& header, const BagTopic& topic)
{
  frame_ = frame_.empty() ? header.frame : frame_;
  if (!frame_changed_ && !header.frame.empty() && header.frame != frame_)
  {
    frame_changed_ = true;
    conventions_.warn(topic.name + ": its scans are in several frames, '" + frame_ + "' and '" +
                      header.frame +
                      "', but are taken as those of one lidar; record a topic for each lidar");
  }
}

Scan RosScanDecoder::decodeCloud(const BagTopic& topic, const BagMessage& message)
{
  const Cloud2 cloud = Cloud2::read(rosReader(topic, message), topic.encoding);
  Scan scan;
  scan.stamp = stampOf(cloud.header, topic, message, cloud.size());
  if (cloud.size() == 0)
  {
    return scan;
  }
  checkFrame(cloud.header, topic);
  const PointField* x = cloud.find("x");
  const PointField* y = cloud.find("y");
  const PointField* z = cloud.find("z");
  if (x == nullptr || y == nullptr || z == nullptr)
  {
    throw UserError(cloud.place + ": has no fields x, y and z");
  }
  for (const PointField* field : {x, y, z})
  {
    cloud.requireNearOrigin(*field);
  }
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

Scan RosScanDecoder::decodeLivox(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  Scan scan;
  const RosHeader header = rosHeader(reader, topic.encoding);
  (void)reader.u64();  // time base: the stamp in nanoseconds
  (void)reader.u32();  // number of points, given again below
  (void)reader.u32();  // number of the lidar, and three reserved bytes
  const std::uint32_t count = reader.u32();
  constexpr std::size_t smallest_point = 19;
  if (count > (reader.left() + smallest_point - 1) / smallest_point)
  {
    reader.fail("damaged: announces " + counted(count, "point") + ", but has " +
                counted(reader.left(), "byte") + " for them");
  }
  scan.stamp = stampOf(header, topic, message, count);
  checkFrame(header, topic);
  for (std::uint32_t i = 0; i < count; ++i)
  {
    scan.time.push_back(1e-9F * static_cast<float>(reader.u32()));
    const auto x = reader.number<float>();
    const auto y = reader.number<float>();
    scan.points.emplace_back(x, y, reader.number<float>());
    scan.intensity.push_back(reader.u8());
    (void)reader.u8();  // tag: the driver's classification of the return
    scan.ring.push_back(reader.u8());
  }
  if (first_ && count > 0)
  {
    conventions_.setTimes("offset_time", 1e-9, false);
    conventions_.note("ring: field line");
  }
  return scan;
}
}  // namespace dyslam
