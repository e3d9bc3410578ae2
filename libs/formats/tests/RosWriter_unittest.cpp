// SPDX-License-Identifier: BSD-3-Clause
// Messages of ROS 2: read back by the readers of bags, by the definitions of their types alone, and
// compared with those of other writers.
#include <dyslam/base/Error.h>
#include <dyslam/formats/RosWriter.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "DecodedMessage.h"
#include "SomeRosScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::vector<RosType> all_types{
    RosType::point_cloud2,  RosType::imu,          RosType::nav_sat_fix,
    RosType::twist_stamped, RosType::pose_stamped, RosType::odometry,
    RosType::path,          RosType::transforms,   RosType::marker_array};

test::DecodedMessage decodedBySchema(RosType type, const std::string& data)
{
  return {rosTypeName(type), rosDefinition(type), data};
}

/** As a bag delivers the message. */
BagTopic topicOfType(RosType type)
{
  std::string name = rosTypeName(type);
  name.erase(name.find("/msg/"), 4);
  return test::topicOf(true, name);
}

Scan scanWithGaps()
{
  Scan scan = test::sweepOf(200);
  scan.points[5].setConstant(std::numeric_limits<float>::quiet_NaN());
  scan.points[6].setZero();
  return scan;
}

bool sameBits(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b)
{
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(Eigen::Vector3f)) == 0;
}

const Pose some_pose = poseFromYpr(1, -2, 3, 0.4, -0.05, 0.02);
}  // namespace

TEST(RosWriter, AScanIsReadBackWithTimesRingsAndPointsWithoutReturn)
{
  const Scan scan = scanWithGaps();
  RosScanDecoder decoder;
  const std::string data = cloudMessage(scan, "lidar");
  const Scan read = decoder.decode(topicOfType(RosType::point_cloud2), test::messageOf(data));
  EXPECT_EQ(scan.stamp, read.stamp);
  EXPECT_TRUE(sameBits(scan.points, read.points));
  EXPECT_EQ(scan.intensity, read.intensity);
  EXPECT_EQ(scan.ring, read.ring);
  EXPECT_EQ(scan.time, read.time);
  EXPECT_TRUE(hasLine(decoder.notes(), "per-point time: field time, seconds from the time stamp"));
  EXPECT_TRUE(hasLine(decoder.notes(), "ring: field ring"));
  EXPECT_TRUE(decoder.warnings().empty());
  const auto message = decodedBySchema(RosType::point_cloud2, data);
  EXPECT_EQ("lidar", message.text("header.frame_id"));
  EXPECT_EQ(22, message.number("point_step"));
  EXPECT_EQ(0, message.number("is_dense")) << "a point is not a number";
  EXPECT_EQ(6U, message.count("fields"));
  EXPECT_EQ("ring", message.text("fields[4].name"));
  EXPECT_EQ(16, message.number("fields[4].offset"));
  EXPECT_EQ(4, message.number("fields[4].datatype"));
}

TEST(RosWriter, AScanHasOnlyTheFieldsThatAreKnown)
{
  Scan scan;
  scan.stamp = 5;
  scan.points = {{1, 2, 3}, {4, 5, 6}};
  const auto message = decodedBySchema(RosType::point_cloud2, cloudMessage(scan, "map"));
  EXPECT_EQ(3U, message.count("fields"));
  EXPECT_EQ(12, message.number("point_step"));
  EXPECT_EQ(24, message.number("row_step"));
  EXPECT_EQ(1, message.number("height"));
  EXPECT_EQ(2, message.number("width"));
  EXPECT_EQ(1, message.number("is_dense"));
  const auto empty = decodedBySchema(RosType::point_cloud2, cloudMessage(Scan(), "map"));
  EXPECT_EQ(0, empty.number("width"));
  EXPECT_TRUE(empty.text("data").empty());
}

TEST(RosWriter, MovingPointsAreAFieldOrAreLeftOut)
{
  const Scan scan = scanWithGaps();
  std::vector<bool> moving(scan.size());
  moving[3] = moving[10] = true;
  const auto message = decodedBySchema(RosType::point_cloud2, cloudMessage(scan, "lidar", moving));
  EXPECT_EQ("moving", message.text("fields[6].name"));
  EXPECT_EQ(2, message.number("fields[6].datatype"));
  const std::string points = message.text("data");
  ASSERT_EQ(23 * scan.size(), points.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    EXPECT_EQ(moving[i] ? 1 : 0, points[23 * i + 22]) << i;
  }
  RosScanDecoder decoder;
  const std::string rest = cloudMessage(scan, "lidar", moving, MovingPoints::left_out);
  const Scan read = decoder.decode(topicOfType(RosType::point_cloud2), test::messageOf(rest));
  ASSERT_EQ(scan.size() - 2, read.size());
  EXPECT_EQ(scan.points[2], read.points[2]);
  EXPECT_EQ(scan.points[4], read.points[3]);
  EXPECT_EQ(scan.ring[11], read.ring[9]);
  EXPECT_EQ(scan.time.back(), read.time.back());
}

TEST(RosWriter, PosesAreThoseOfTheReader)
{
  const RosPose pose{1600000000.25, "map", "base_link", some_pose};
  const auto expectPose = [&](RosType type, const std::string& data, bool with_child)
  {
    const auto poses = decodeRosPoses(topicOfType(type), test::messageOf(data));
    ASSERT_FALSE(poses.empty());
    EXPECT_EQ(pose.stamp, poses.back().stamp);
    EXPECT_EQ("map", poses.back().parent);
    EXPECT_EQ(with_child ? "base_link" : "", poses.back().child);
    EXPECT_TRUE(some_pose.isApprox(poses.back().pose, 1e-12));
  };
  expectPose(RosType::pose_stamped, poseMessage(pose), false);
  expectPose(RosType::odometry, odometryMessage(pose, {}), true);
  expectPose(RosType::transforms, transformsMessage({{1, "a", "bcd", Pose::Identity()}, pose}),
             true);
  EXPECT_EQ(test::poseStamped(true, pose.stamp, some_pose), poseMessage(pose));
  EXPECT_EQ(test::transforms(true, pose.stamp, {{"base_link", some_pose}}),
            transformsMessage({pose}));
}

TEST(RosWriter, APathHasEveryPoseWithItsStamp)
{
  Trajectory poses;
  poses.push_back(10, Pose::Identity());
  poses.push_back(10.5, some_pose);
  const auto message = decodedBySchema(RosType::path, pathMessage(12, "map", poses));
  EXPECT_EQ(12, message.number("header.stamp.sec"));
  ASSERT_EQ(2U, message.count("poses"));
  EXPECT_EQ("map", message.text("poses[1].header.frame_id"));
  EXPECT_EQ(500000000, message.number("poses[1].header.stamp.nanosec"));
  EXPECT_EQ(-2, message.number("poses[1].pose.position.y"));
  EXPECT_NEAR(std::sin(0.2), message.number("poses[1].pose.orientation.z"), 0.01);
  EXPECT_EQ(0U, decodedBySchema(RosType::path, pathMessage(1, "map", {})).count("poses"));
}

TEST(RosWriter, VelocitiesAreThoseOfTheReader)
{
  RosTwist twist;
  twist.stamp = 1600000000.5;
  twist.frame = "base_link";
  twist.linear = {8, 0.5, -0.1};
  twist.angular = {0.01, 0.02, 0.3};
  const auto expectTwist = [&](RosType type, const std::string& data)
  {
    const auto read = decodeRosTwist(topicOfType(type), test::messageOf(data));
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(twist.stamp, read->stamp);
    EXPECT_EQ("base_link", read->frame);
    EXPECT_EQ(twist.linear, read->linear);
    EXPECT_EQ(twist.angular, read->angular);
  };
  expectTwist(RosType::twist_stamped, twistMessage(twist));
  const std::string odometry =
      odometryMessage({twist.stamp, "odom", "base_link", some_pose}, twist);
  expectTwist(RosType::odometry, odometry);
  EXPECT_EQ(test::odometry(true, twist.stamp, some_pose, twist.linear, twist.angular), odometry);
  EXPECT_EQ(test::twistStamped(true, twist.stamp, twist.linear, twist.angular),
            twistMessage(twist));
}

TEST(RosWriter, TheCovariancesOfAnOdometry)
{
  RosOdometryCovariances covariances;
  for (int row = 0; row < 6; ++row)
  {
    for (int column = 0; column < 6; ++column)
    {
      covariances.pose(row, column) = 10 * row + column;
      covariances.twist(row, column) = 100 + 10 * row + column;
    }
  }
  const RosPose pose{1600000000.5, "map", "base_link", some_pose};
  const auto given = decodedBySchema(RosType::odometry, odometryMessage(pose, {}, covariances));
  const auto unknown = decodedBySchema(RosType::odometry, odometryMessage(pose, {}));
  for (int i = 0; i < 36; ++i)
  {
    const std::string at = "covariance[" + std::to_string(i) + "]";
    const int value = 10 * (i / 6) + i % 6;
    EXPECT_EQ(value, given.number("pose." + at)) << "row by row";
    EXPECT_EQ(100 + value, given.number("twist." + at));
    EXPECT_EQ(0, unknown.number("pose." + at));
    EXPECT_EQ(0, unknown.number("twist." + at));
  }
}

TEST(RosWriter, AnImuIsReadBack)
{
  RosImu imu{1600000000.5, "imu", {0.1, 0.2, 0.3}, Eigen::Vector3d(0, 0, 9.81)};
  for (const bool has_acceleration : {true, false})
  {
    if (!has_acceleration)
    {
      imu.acceleration.reset();
    }
    const std::string data = imuMessage(imu);
    const auto read = decodeRosImu(topicOfType(RosType::imu), test::messageOf(data));
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(imu.stamp, read->stamp);
    EXPECT_EQ("imu", read->frame);
    EXPECT_EQ(imu.angular_velocity, read->angular_velocity);
    EXPECT_EQ(imu.acceleration, read->acceleration);
    const auto message = decodedBySchema(RosType::imu, data);
    EXPECT_EQ(-1, message.number("orientation_covariance[0]")) << "it is not known";
  }
}

TEST(RosWriter, AFixIsReadBack)
{
  RosFix fix{1600000000.5, "gnss", {49.01, 8.4, 115}, 1.5, 3};
  for (const double sigma : {1.5, 0.0})
  {
    fix.horizontal_sigma = sigma;
    const std::string data = fixMessage(fix);
    const auto read = decodeRosFix(topicOfType(RosType::nav_sat_fix), test::messageOf(data));
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(fix.stamp, read->stamp);
    EXPECT_EQ("gnss", read->frame);
    EXPECT_EQ(fix.position.latitude, read->position.latitude);
    EXPECT_EQ(fix.position.height, read->position.height);
    EXPECT_EQ(sigma, read->horizontal_sigma);
    EXPECT_EQ(sigma > 0 ? 3 : 0, read->vertical_sigma);
    const auto message = decodedBySchema(RosType::nav_sat_fix, data);
    EXPECT_EQ(sigma > 0 ? 2 : 0, message.number("position_covariance_type"));
    EXPECT_EQ(0, message.number("status.status"));
  }
}

TEST(RosWriter, MarkersReplaceTheEarlierOnes)
{
  RosMarker box;
  box.group = "boxes";
  box.id = 7;
  box.pose = some_pose;
  box.scale = {4, 2, 1.5};
  box.colour = {1, 0.5F, 0.25F, 0.75F};
  RosMarker arrow;
  arrow.group = "velocities";
  arrow.shape = RosMarker::Shape::arrow;
  arrow.points = {{1, 2, 3}, {4, 5, 6}};
  RosMarker name;
  name.shape = RosMarker::Shape::text;
  name.text = "7 Car 3.2 m/s";
  const auto message =
      decodedBySchema(RosType::marker_array, markersMessage(12.25, "map", {box, arrow, name}));
  ASSERT_EQ(4U, message.count("markers"));
  EXPECT_EQ(3, message.number("markers[0].action")) << "DELETEALL";
  for (const std::string marker : {"markers[1]", "markers[2]", "markers[3]"})
  {
    EXPECT_EQ(0, message.number(marker + ".action"));
    EXPECT_EQ("map", message.text(marker + ".header.frame_id"));
    EXPECT_EQ(250000000, message.number(marker + ".header.stamp.nanosec"));
    EXPECT_EQ(0, message.number(marker + ".lifetime.sec"));
  }
  EXPECT_EQ("boxes", message.text("markers[1].ns"));
  EXPECT_EQ(7, message.number("markers[1].id"));
  EXPECT_EQ(1, message.number("markers[1].type")) << "CUBE";
  EXPECT_EQ(1.5, message.number("markers[1].scale.z"));
  EXPECT_EQ(0.75, message.number("markers[1].color.a"));
  EXPECT_EQ(3, message.number("markers[1].pose.position.z"));
  EXPECT_EQ(0, message.number("markers[2].type")) << "ARROW";
  ASSERT_EQ(2U, message.count("markers[2].points"));
  EXPECT_EQ(6, message.number("markers[2].points[1].z"));
  EXPECT_EQ(9, message.number("markers[3].type")) << "TEXT_VIEW_FACING";
  EXPECT_EQ("7 Car 3.2 m/s", message.text("markers[3].text"));
  EXPECT_EQ(1U,
            decodedBySchema(RosType::marker_array, markersMessage(1, "map", {})).count("markers"));
}

TEST(RosWriter, DefinitionsHaveNoCommentsAndEveryType)
{
  for (const RosType type : all_types)
  {
    const std::string text = rosDefinition(type);
    EXPECT_EQ(std::string::npos, text.find('#')) << text;
    EXPECT_EQ(std::string::npos, text.find("\n\n")) << text;
    EXPECT_EQ('\n', text.back());
    EXPECT_TRUE(contains(rosTypeName(type), "/msg/"));
  }
  EXPECT_EQ("sensor_msgs/msg/PointCloud2", rosTypeName(RosType::point_cloud2));
  EXPECT_EQ(
      "std_msgs/Header header\nTwist twist\n" + std::string(80, '=') +
          "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
          std::string(80, '=') + "\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n" +
          std::string(80, '=') + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" +
          std::string(80, '=') + "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n",
      rosDefinition(RosType::twist_stamped));
}

TEST(RosWriter, StampsAreNanosecondsThatAHeaderHolds)
{
  EXPECT_EQ(0U, rosNanoseconds(0));
  EXPECT_EQ(1600000000250000000U, rosNanoseconds(1600000000.25));
  EXPECT_EQ(999999999U, rosNanoseconds(0.999999999));
  EXPECT_EQ(2000000000U, rosNanoseconds(1.9999999999)) << "rounded up to a whole second";
  for (const double stamp :
       {-1e-9, 2147483648.0, std::nan(""), std::numeric_limits<double>::infinity()})
  {
    EXPECT_THROW((void)rosNanoseconds(stamp), UserError) << stamp;
  }
}
}  // namespace dyslam
