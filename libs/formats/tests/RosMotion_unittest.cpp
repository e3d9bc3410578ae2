// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/RosMessages.h>
#include <gtest/gtest.h>

#include <limits>

#include "RosMessageWriters.h"
#include "SingleMessage.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::messageOf;
using test::topicOf;

constexpr double motion_stamp = 1600000000.25;
const Eigen::Vector3d some_linear(4, 0.5, -0.25);
const Eigen::Vector3d some_angular(0.125, -0.5, 0.75);

std::optional<RosImu> decodedImu(bool cdr, double stamp, const test::ImuValues& values)
{
  const std::string data = test::imu(cdr, stamp, values);
  return decodeRosImu(topicOf(cdr, "sensor_msgs/Imu"), messageOf(data));
}
}  // namespace

TEST(RosImus, BothSerialisations)
{
  // Frames of every length, for the alignment of the numbers behind them.
  for (const std::string frame : {"", "imu", "imu_link", "os_sensor/imu"})
  {
    for (const bool cdr : {false, true})
    {
      ASSERT_TRUE(isRosImu(topicOf(cdr, "sensor_msgs/Imu")));
      const auto imu = decodedImu(cdr, motion_stamp, {frame, some_angular, some_linear});
      ASSERT_TRUE(imu);
      EXPECT_EQ(motion_stamp, imu->stamp);
      EXPECT_EQ(frame, imu->frame);
      EXPECT_EQ(some_angular, imu->angular_velocity);
      ASSERT_TRUE(imu->acceleration);
      EXPECT_EQ(some_linear, *imu->acceleration);
    }
  }
  EXPECT_FALSE(isRosImu(topicOf(true, "nav_msgs/Odometry")));
  BagTopic json = topicOf(true, "sensor_msgs/Imu");
  json.encoding = RosEncoding::other;
  EXPECT_FALSE(isRosImu(json));
}

TEST(RosImus, UnknownValuesAreLeftOut)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const bool cdr : {false, true})
  {
    const auto no_acceleration =
        decodedImu(cdr, motion_stamp, {"imu", some_angular, some_linear, 0.1, -1});
    ASSERT_TRUE(no_acceleration);
    EXPECT_EQ(some_angular, no_acceleration->angular_velocity);
    EXPECT_FALSE(no_acceleration->acceleration);
    EXPECT_FALSE(decodedImu(cdr, motion_stamp, {"imu", some_angular, some_linear, -1, 0.1}));
    EXPECT_FALSE(decodedImu(cdr, motion_stamp, {"imu", {0, nan, 0}, some_linear}));
    const auto no_number = decodedImu(cdr, motion_stamp, {"imu", some_angular, {nan, 0, 0}});
    ASSERT_TRUE(no_number);
    EXPECT_FALSE(no_number->acceleration);
    EXPECT_EQ(12, decodedImu(cdr, 0, {})->stamp);  // when it was recorded
  }
}

TEST(RosTwists, EveryTypeInBothSerialisations)
{
  const Pose pose = poseFromYpr(1, 2, 3, 0.5, -0.2, 0.1);
  for (const bool cdr : {false, true})
  {
    const auto check = [&](const std::string& type, const std::string& data)
    {
      ASSERT_TRUE(isRosTwist(topicOf(cdr, type)));
      const auto twist = decodeRosTwist(topicOf(cdr, type), messageOf(data));
      ASSERT_TRUE(twist);
      EXPECT_EQ(motion_stamp, twist->stamp);
      EXPECT_EQ("base_link", twist->frame);
      EXPECT_EQ(some_linear, twist->linear);
      EXPECT_EQ(some_angular, twist->angular);
      EXPECT_EQ(type == "nav_msgs/Odometry", twist->T_parent_body.has_value());
      EXPECT_TRUE(twist->T_parent_body.value_or(pose).isApprox(pose, 1e-12));
    };
    check("nav_msgs/Odometry", test::odometry(cdr, motion_stamp, pose, some_linear, some_angular));
    check("geometry_msgs/TwistStamped",
          test::twistStamped(cdr, motion_stamp, some_linear, some_angular));
    check("geometry_msgs/TwistWithCovarianceStamped",
          test::twistStamped(cdr, motion_stamp, some_linear, some_angular, true));
    EXPECT_FALSE(isRosTwist(topicOf(cdr, "geometry_msgs/Twist")));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::string bad = test::twistStamped(cdr, motion_stamp, {nan, 0, 0}, some_angular);
    EXPECT_FALSE(decodeRosTwist(topicOf(cdr, "geometry_msgs/TwistStamped"), messageOf(bad)));
  }
}

TEST(RosTwists, AnOdometryWithoutAPoseHasAVelocity)
{
  Pose pose = Pose::Identity();
  pose.translation().x() = std::numeric_limits<double>::quiet_NaN();
  const std::string data = test::odometry(true, motion_stamp, pose, some_linear, some_angular);
  const auto twist = decodeRosTwist(topicOf(true, "nav_msgs/Odometry"), messageOf(data));
  ASSERT_TRUE(twist);
  EXPECT_EQ(some_linear, twist->linear);
  EXPECT_FALSE(twist->T_parent_body);
}

TEST(RosMotion, DamagedMessagesAreRefused)
{
  for (const bool cdr : {false, true})
  {
    const std::string imu = test::imu(cdr, motion_stamp, {});
    const std::string twist = test::twistStamped(cdr, motion_stamp, some_linear, some_angular);
    for (std::size_t size = 0; size < imu.size(); size += 7)
    {
      const std::string cut = imu.substr(0, size);
      const auto message = messageOfError<UserError>(
          [&] { (void)decodeRosImu(topicOf(cdr, "sensor_msgs/Imu"), messageOf(cut)); });
      EXPECT_TRUE(contains(message, "x.bag: message at byte 99 of /topic")) << message;
    }
    for (std::size_t size = 0; size < twist.size(); size += 7)
    {
      const std::string cut = twist.substr(0, size);
      const auto message = messageOfError<UserError>(
          [&]
          { (void)decodeRosTwist(topicOf(cdr, "geometry_msgs/TwistStamped"), messageOf(cut)); });
      EXPECT_TRUE(contains(message, "x.bag: message at byte 99 of /topic")) << message;
    }
  }
}

TEST(RosTransforms, ChainsMeetInACommonParent)
{
  const Pose T_base_mast = poseFromYpr(0.5, 0, 1, 0.3, 0, 0);
  const Pose T_mast_lidar = poseFromYpr(0, 0.1, 0.2, M_PI, 0, 0);
  const Pose T_base_imu = poseFromYpr(-0.2, 0, 0.1, 0, 0, M_PI / 2);
  const RosTransforms transforms{{"mast", {0, "base_link", "mast", T_base_mast}},
                                 {"lidar", {0, "mast", "lidar", T_mast_lidar}},
                                 {"imu", {0, "base_link", "imu", T_base_imu}},
                                 {"camera", {0, "tripod", "camera", Pose::Identity()}},
                                 {"a", {0, "b", "a", Pose::Identity()}},
                                 {"b", {0, "a", "b", Pose::Identity()}}};
  const auto T_lidar_imu = transformBetween(transforms, "lidar", "imu");
  ASSERT_TRUE(T_lidar_imu);
  const Pose expected = (T_base_mast * T_mast_lidar).inverse() * T_base_imu;
  EXPECT_TRUE(T_lidar_imu->isApprox(expected, 1e-12));
  EXPECT_TRUE(transformBetween(transforms, "mast", "lidar")->isApprox(T_mast_lidar, 1e-12));
  EXPECT_TRUE(transformBetween({}, "lidar", "lidar")->isApprox(Pose::Identity(), 1e-12));
  EXPECT_FALSE(transformBetween(transforms, "lidar", "camera"));
  EXPECT_FALSE(transformBetween(transforms, "lidar", "nowhere"));
  EXPECT_FALSE(transformBetween(transforms, "lidar", "a"));  // a loop ends
}
}  // namespace dyslam
