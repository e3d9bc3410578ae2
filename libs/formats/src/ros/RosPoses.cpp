// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RosMessages.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "RosReader.h"

namespace dyslam
{
namespace
{
enum class Kind
{
  none,
  pose,       //!< header, pose
  child,      //!< header, child frame, pose
  transforms  //!< many of the second kind
};

Kind kindOf(const std::string& type)
{
  if (type == "geometry_msgs/PoseStamped" || type == "geometry_msgs/PoseWithCovarianceStamped")
  {
    return Kind::pose;
  }
  if (type == "nav_msgs/Odometry" || type == "geometry_msgs/TransformStamped")
  {
    return Kind::child;
  }
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage" ? Kind::transforms : Kind::none;
}

/** Position or translation, then a quaternion, x first: the same in Pose and Transform. Nothing if
 * the numbers are no pose. */
std::optional<Pose> readPose(ByteReader& reader)
{
  Pose pose = Pose::Identity();
  for (int i = 0; i < 3; ++i)
  {
    pose.translation()[i] = reader.f64();
  }
  Eigen::Quaterniond q;
  q.x() = reader.f64();
  q.y() = reader.f64();
  q.z() = reader.f64();
  q.w() = reader.f64();
  constexpr double tolerance = 0.02;
  if (!pose.translation().allFinite() || !(std::abs(q.norm() - 1) < tolerance))
  {
    return std::nullopt;
  }
  pose.linear() = q.normalized().toRotationMatrix();
  return pose;
}

std::optional<RosPose> readOne(ByteReader& reader, RosEncoding encoding, bool with_child)
{
  const RosHeader header = rosHeader(reader, encoding);
  RosPose pose;
  pose.stamp = header.stamp;
  pose.parent = header.frame;
  pose.child = with_child ? plainFrame(rosString(reader)) : "";
  const std::optional<Pose> read = readPose(reader);
  if (!read)
  {
    return std::nullopt;
  }
  pose.pose = *read;
  return pose;
}
}  // namespace

std::string plainFrame(std::string name)
{
  return name.erase(0, std::min(name.find_first_not_of('/'), name.size()));
}

bool isRosPose(const BagTopic& topic)
{
  return topic.encoding != RosEncoding::other && kindOf(topic.type) != Kind::none;
}

std::vector<RosPose> decodeRosPoses(const BagTopic& topic,
                                    const BagMessage& message,
                                    std::size_t* left_out)
{
  const Kind kind = kindOf(topic.type);
  ByteReader reader = rosReader(topic, message);
  std::vector<RosPose> poses;
  const std::uint32_t count = kind == Kind::transforms ? reader.u32() : 1;
  for (std::uint32_t i = 0; i < count; ++i)  // each takes bytes: no count outruns the message
  {
    if (const auto pose = readOne(reader, topic.encoding, kind != Kind::pose))
    {
      poses.push_back(*pose);
    }
    else if (left_out != nullptr)
    {
      ++*left_out;
    }
  }
  return poses;
}
}  // namespace dyslam
