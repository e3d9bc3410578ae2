// SPDX-License-Identifier: BSD-3-Clause
#include "RosMessageWriters.h"

#include <dyslam/base/Bytes.h>

#include <cmath>

namespace dyslam::test
{
namespace
{
void putPose(MessageBytes& message, const Pose& pose)
{
  const Eigen::Quaterniond q(pose.rotation());
  for (const double value : {pose.translation().x(), pose.translation().y(), pose.translation().z(),
                             q.x(), q.y(), q.z(), q.w()})
  {
    message.put(value);
  }
}

void putVector(MessageBytes& message, const Eigen::Vector3d& vector)
{
  message.put(vector.x()).put(vector.y()).put(vector.z());
}

/** `count` numbers, all zero but the first. */
void putCovariance(MessageBytes& message, double first, int count)
{
  for (int i = 0; i < count; ++i)
  {
    message.put(i == 0 ? first : 0.0);
  }
}
}  // namespace

std::uint64_t nanoseconds(double stamp)
{
  const double whole = std::floor(stamp);
  return static_cast<std::uint64_t>(whole) * 1000000000U +
         static_cast<std::uint64_t>(std::llround((stamp - whole) * 1e9));
}

MessageBytes& MessageBytes::text(const std::string& value)
{
  return block(cdr_ ? value + '\0' : value);
}

MessageBytes& MessageBytes::block(const std::string& value)
{
  put(static_cast<std::uint32_t>(value.size()));
  bytes_ += value;
  return *this;
}

MessageBytes& MessageBytes::header(double stamp, const std::string& frame)
{
  if (!cdr_)
  {
    put(std::uint32_t{7});
  }
  put(static_cast<std::uint32_t>(nanoseconds(stamp) / 1000000000U));
  put(static_cast<std::uint32_t>(nanoseconds(stamp) % 1000000000U));
  return text(frame);
}

std::string pointCloud2(bool cdr,
                        double stamp,
                        const std::vector<CloudField>& fields,
                        std::uint32_t rows,
                        const std::string& frame)
{
  const auto sizeOf = [](std::uint8_t type) -> std::uint32_t {
    return type == 2 ? 1 : type == 4 ? 2 : type == 8 ? 8 : 4;
  };
  MessageBytes message(cdr);
  const auto points =
      fields.empty() ? 0U : static_cast<std::uint32_t>(fields.front().values.size());
  message.header(stamp, frame).put(rows).put(points / rows);
  message.put(static_cast<std::uint32_t>(fields.size()));
  std::uint32_t step = 3;  // drivers leave gaps, too
  std::vector<std::uint32_t> offsets;
  for (const CloudField& f : fields)
  {
    offsets.push_back(step);
    message.text(f.name).put(step).put(f.type).put(std::uint32_t{1});
    step += sizeOf(f.type);
  }
  std::string data(static_cast<std::size_t>(points) * step, '\0');
  for (std::size_t i = 0; i < fields.size(); ++i)
  {
    for (std::size_t j = 0; j < points; ++j)
    {
      std::string value;
      const double v = fields[i].values[j];
      switch (fields[i].type)
      {
        case 2:
          appendBytes(value, static_cast<std::uint8_t>(v));
          break;
        case 4:
          appendBytes(value, static_cast<std::uint16_t>(v));
          break;
        case 6:
          appendBytes(value, static_cast<std::uint32_t>(v));
          break;
        case 7:
          appendBytes(value, static_cast<float>(v));
          break;
        default:
          appendBytes(value, v);
      }
      data.replace(j * step + offsets[i], value.size(), value);
    }
  }
  message.put(std::uint8_t{0}).put(step).put(step * (points / rows)).block(data);
  return message.put(std::uint8_t{1}).bytes();
}

std::vector<CloudField> velodyneFields(const Scan& scan)
{
  std::vector<CloudField> fields{{"x", 7, {}},         {"y", 7, {}},    {"z", 7, {}},
                                 {"intensity", 7, {}}, {"ring", 4, {}}, {"time", 7, {}}};
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      fields[static_cast<std::size_t>(axis)].values.push_back(scan.points[i][axis]);
    }
    fields[3].values.push_back(scan.intensity[i]);
    fields[4].values.push_back(scan.ring[i]);
    fields[5].values.push_back(scan.time[i]);
  }
  return fields;
}

std::string velodyneScan(bool cdr,
                         double stamp,
                         const std::vector<std::pair<double, std::string>>& packets)
{
  MessageBytes message(cdr);
  message.header(stamp, "velodyne").put(static_cast<std::uint32_t>(packets.size()));
  for (const auto& [received, bytes] : packets)
  {
    message.put(static_cast<std::uint32_t>(nanoseconds(received) / 1000000000U));
    message.put(static_cast<std::uint32_t>(nanoseconds(received) % 1000000000U));
    for (const char byte : bytes)
    {
      message.put(byte);
    }
  }
  return message.bytes();
}

std::string hesaiMessage(bool cdr,
                         double stamp,
                         const std::vector<std::pair<double, std::string>>& packets,
                         HesaiMessage kind)
{
  constexpr std::size_t room = 1500;
  MessageBytes message(cdr);
  message.header(stamp, "hesai").put(static_cast<std::uint32_t>(packets.size()));
  for (const auto& [received, bytes] : packets)
  {
    const bool has_stamp = kind != HesaiMessage::udp_frame || received == packets.front().first;
    const std::uint64_t time = has_stamp ? nanoseconds(received) : 0;
    message.put(static_cast<std::uint32_t>(time / 1000000000U));
    message.put(static_cast<std::uint32_t>(time % 1000000000U));
    if (kind != HesaiMessage::pandar_scan)
    {
      message.block(bytes);
    }
    else
    {
      for (const char byte : bytes + std::string(room - bytes.size(), '\0'))
      {
        message.put(byte);
      }
    }
    if (kind != HesaiMessage::nebula_packets)
    {
      message.put(static_cast<std::uint32_t>(bytes.size()));
    }
  }
  return message.bytes();
}

std::string ousterPacketMessage(bool cdr, const std::string& packet)
{
  return MessageBytes(cdr).block(packet).bytes();
}

std::string stringMessage(bool cdr, const std::string& text)
{
  return MessageBytes(cdr).text(text).bytes();
}

std::string poseStamped(bool cdr, double stamp, const Pose& pose)
{
  MessageBytes message(cdr);
  message.header(stamp, "map");
  putPose(message, pose);
  return message.bytes();
}

std::string odometry(bool cdr,
                     double stamp,
                     const Pose& pose,
                     const Eigen::Vector3d& linear,
                     const Eigen::Vector3d& angular)
{
  MessageBytes message(cdr);
  message.header(stamp, "odom").text("base_link");
  putPose(message, pose);
  putCovariance(message, 0, 36);
  putVector(message, linear);
  putVector(message, angular);
  putCovariance(message, 0, 36);
  return message.bytes();
}

std::string twistStamped(bool cdr,
                         double stamp,
                         const Eigen::Vector3d& linear,
                         const Eigen::Vector3d& angular,
                         bool with_covariance)
{
  MessageBytes message(cdr);
  message.header(stamp, "base_link");
  putVector(message, linear);
  putVector(message, angular);
  putCovariance(message, 0.1, with_covariance ? 36 : 0);
  return message.bytes();
}

std::string imu(bool cdr, double stamp, const ImuValues& values)
{
  MessageBytes message(cdr);
  message.header(stamp, values.frame);
  for (const double value : {0.0, 0.0, 0.0, 1.0})
  {
    message.put(value);
  }
  putCovariance(message, -1, 9);
  putVector(message, values.angular_velocity);
  putCovariance(message, values.angular_velocity_variance, 9);
  putVector(message, values.acceleration);
  putCovariance(message, values.acceleration_variance, 9);
  return message.bytes();
}

std::string navSatFix(bool cdr, double stamp, const FixValues& values)
{
  MessageBytes message(cdr);
  message.header(stamp, values.frame);
  message.put(static_cast<std::int8_t>(values.status));
  message.put(static_cast<std::uint16_t>(1));
  message.put(values.latitude).put(values.longitude).put(values.altitude);
  for (int i = 0; i < 9; ++i)
  {
    message.put(i % 4 != 0 ? 0.0 : (i == 8 ? 4 : 1) * values.variance);
  }
  message.put(static_cast<std::uint8_t>(values.variance > 0 ? 2 : 0));
  return message.bytes();
}

std::string transforms(bool cdr,
                       double stamp,
                       const std::vector<std::pair<std::string, Pose>>& children,
                       const std::string& parent)
{
  MessageBytes message(cdr);
  message.put(static_cast<std::uint32_t>(children.size()));
  for (const auto& [child, pose] : children)
  {
    message.header(stamp, parent).text(child);
    putPose(message, pose);
  }
  return message.bytes();
}

std::string livoxMessage(bool cdr, const Scan& scan)
{
  MessageBytes message(cdr);
  const auto count = static_cast<std::uint32_t>(scan.size());
  message.header(scan.stamp, "livox").put(nanoseconds(scan.stamp)).put(count);
  message.put(std::uint8_t{1}).put(std::uint8_t{0}).put(std::uint8_t{0}).put(std::uint8_t{0});
  message.put(count);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    message.put(static_cast<std::uint32_t>(std::lround(scan.time[i] * 1e9)));
    message.put(scan.points[i].x()).put(scan.points[i].y()).put(scan.points[i].z());
    message.put(static_cast<std::uint8_t>(scan.intensity[i])).put(std::uint8_t{16});
    message.put(static_cast<std::uint8_t>(scan.ring[i]));
  }
  return message.bytes();
}
}  // namespace dyslam::test
