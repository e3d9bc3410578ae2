// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RosMessages.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "RosReader.h"

namespace dyslam
{
namespace
{
constexpr const char* odometry_type = "nav_msgs/Odometry";

void skipDoubles(ByteReader& reader, std::size_t count)
{
  reader.align(sizeof(double));
  (void)reader.take(count * sizeof(double));
}

Eigen::Vector3d readVector3(ByteReader& reader)
{
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i)
  {
    vector[i] = reader.f64();
  }
  return vector;
}

/** A vector with its covariance of 9 numbers, the first of which is -1 where the sensor does not
 * measure it. */
std::optional<Eigen::Vector3d> readMeasuredVector3(ByteReader& reader)
{
  const Eigen::Vector3d vector = readVector3(reader);
  const bool is_measured = reader.f64() != -1;
  skipDoubles(reader, 8);
  return is_measured && vector.allFinite() ? std::optional(vector) : std::nullopt;
}

double stampOf(const RosHeader& header, const BagMessage& message)
{
  return header.stamp != 0 ? header.stamp : message.recorded;
}
}  // namespace

bool isRosImu(const BagTopic& topic)
{
  return topic.encoding != RosEncoding::other && topic.type == "sensor_msgs/Imu";
}

std::optional<RosImu> decodeRosImu(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  const RosHeader header = rosHeader(reader, topic.encoding);
  skipDoubles(reader, 4 + 9);  // orientation
  const std::optional<Eigen::Vector3d> angular_velocity = readMeasuredVector3(reader);
  const std::optional<Eigen::Vector3d> acceleration = readMeasuredVector3(reader);
  if (!angular_velocity)
  {
    return std::nullopt;
  }
  return RosImu{stampOf(header, message), header.frame, *angular_velocity, acceleration};
}

bool isRosFix(const BagTopic& topic)
{
  return topic.encoding != RosEncoding::other && topic.type == "sensor_msgs/NavSatFix";
}

std::optional<RosFix> decodeRosFix(const BagTopic& topic,
                                   const BagMessage& message,
                                   std::size_t* swapped)
{
  ByteReader reader = rosReader(topic, message);
  const RosHeader header = rosHeader(reader, topic.encoding);
  RosFix fix;
  fix.stamp = stampOf(header, message);
  fix.frame = header.frame;
  const auto status = static_cast<std::int8_t>(reader.u8());
  (void)reader.u16();  // the satellite systems
  fix.position.latitude = reader.f64();
  fix.position.longitude = reader.f64();
  fix.position.height = reader.f64();
  std::array<double, 9> covariance{};
  for (double& value : covariance)
  {
    value = reader.f64();
  }
  const bool is_known = reader.u8() != 0;
  const double horizontal = 0.5 * (covariance[0] + covariance[4]);
  if (is_known && std::isfinite(horizontal + covariance[8]) && horizontal > 0 && covariance[8] > 0)
  {
    fix.horizontal_sigma = std::sqrt(horizontal);
    fix.vertical_sigma = std::sqrt(covariance[8]);
  }
  if (swapped != nullptr && status >= 0 && !isOnEarth(fix.position) &&
      isOnEarth({fix.position.longitude, fix.position.latitude, fix.position.height}))
  {
    ++*swapped;
  }
  return status >= 0 && isOnEarth(fix.position) ? std::optional(fix) : std::nullopt;
}

bool isRosTwist(const BagTopic& topic)
{
  return topic.encoding != RosEncoding::other &&
         (topic.type == odometry_type || topic.type == "geometry_msgs/TwistStamped" ||
          topic.type == "geometry_msgs/TwistWithCovarianceStamped");
}

bool isMapOdometry(Bag& bag, std::size_t topic)
{
  const BagTopic& read = bag.topics()[topic];
  return read.type == odometry_type && isRosTwist(read) && frameOfTopic(bag, topic) == "map";
}

std::optional<RosTwist> decodeRosTwist(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  const RosHeader header = rosHeader(reader, topic.encoding);
  RosTwist twist;
  twist.stamp = stampOf(header, message);
  twist.frame = header.frame;
  if (topic.type == odometry_type)
  {
    twist.frame = plainFrame(rosString(reader));
    skipDoubles(reader, 7 + 36);  // pose
    const std::vector<RosPose> poses = decodeRosPoses(topic, message);
    twist.T_parent_body = poses.empty() ? std::nullopt : std::optional(poses.front().pose);
  }
  twist.linear = readVector3(reader);
  twist.angular = readVector3(reader);
  return twist.linear.allFinite() && twist.angular.allFinite() ? std::optional(twist)
                                                               : std::nullopt;
}
}  // namespace dyslam
