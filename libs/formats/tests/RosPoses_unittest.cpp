// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/RosMessages.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SingleMessage.h"
#include "SomeRosScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::messageOf;
using test::sweep_stamp;
using test::sweepOf;
using test::topicOf;
}  // namespace

TEST(RosPoses, StaticTransformsOfANamespace)
{
  const TestFolder folder;
  const auto childrenOf = [&folder](const std::vector<std::string>& topics)
  {
    std::vector<test::TestMessage> messages;
    for (const std::string& topic : topics)
    {
      messages.push_back(
          {topic, "tf2_msgs/TFMessage", sweep_stamp,
           test::transforms(true, sweep_stamp, {{"of " + topic, Pose::Identity()}})});
    }
    test::writeBag(folder.file("x.mcap"), messages);
    const auto bag = openBag(folder.file("x.mcap"));
    std::vector<std::string> children;
    for (const auto& [child, transform] : staticTransforms(*bag))
    {
      children.push_back(child);
    }
    return children;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(childrenOf({"/robot/tf_static"}), Names{"of /robot/tf_static"});
  EXPECT_EQ(childrenOf({"/robot/tf_static", "/tf_static"}), Names{"of /tf_static"});
  EXPECT_EQ(childrenOf({"tf_static"}), Names{"of tf_static"});
  EXPECT_EQ(childrenOf({"/a/tf_static", "/b/tf_static"}), Names());
  EXPECT_EQ(childrenOf({"/my_tf_static"}), Names());
}

TEST(RosPoses, ConflictsOfStaticTransforms)
{
  const TestFolder folder;
  const auto conflictsOf =
      [&folder](const std::vector<std::pair<std::string, Pose>>& parents_of_lidar)
  {
    std::vector<test::TestMessage> messages;
    for (const auto& [parent, pose] : parents_of_lidar)
    {
      messages.push_back({"/tf_static", "tf2_msgs/TFMessage", sweep_stamp,
                          test::transforms(true, sweep_stamp, {{"lidar", pose}}, parent)});
    }
    test::writeBag(folder.file("x.mcap"), messages);
    const auto bag = openBag(folder.file("x.mcap"));
    std::vector<std::string> conflicts;
    const RosTransforms transforms = staticTransforms(*bag, &conflicts);
    EXPECT_EQ(transforms.at("lidar").parent, parents_of_lidar.back().first);
    EXPECT_TRUE(transforms.at("lidar").pose.isApprox(parents_of_lidar.back().second, 1e-9));
    return conflicts;
  };
  using Lines = std::vector<std::string>;
  const Pose low = poseFromYpr(0, 0, 1, 0, 0, 0);
  const Pose high = poseFromYpr(0, 0, 2, 0, 0, 0);
  EXPECT_EQ(conflictsOf({{"base_link", low}, {"base_link", low}}), Lines());
  EXPECT_EQ(
      conflictsOf({{"base_link", low}, {"mast", low}}),
      Lines{
          "/tf_static states two parents of 'lidar', 'base_link' and 'mast'; the last one counts"});
  EXPECT_EQ(conflictsOf({{"base_link", low}, {"base_link", high}}),
            Lines{"/tf_static states two poses of 'lidar' in 'base_link'; the last one counts"});
}

/** As ROS 1's static_transform_publisher repeats them, beside the moving ones. */
TEST(RosPoses, ConstantTransformsOfTf)
{
  const TestFolder folder;
  const Pose T_base_lidar = poseFromYpr(1, 0, 1.7, M_PI, 0, 0);
  for (const std::string ending : {".bag", ".mcap"})
  {
    const bool cdr = test::holdsCdr("x" + ending);
    std::vector<test::TestMessage> messages;
    for (int i = 0; i < 30; ++i)
    {
      const double stamp = sweep_stamp + 0.1 * i;
      const Pose moving = poseFromYpr(0.1 * i, 0, 0, 0, 0, 0);
      messages.push_back({"/points", "sensor_msgs/PointCloud2", stamp,
                          test::pointCloud2(cdr, stamp, test::velodyneFields(sweepOf(50)))});
      messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp,
                          test::transforms(cdr, stamp, {{"base_link", moving}}, "odom")});
      messages.push_back({"/tf", "tf2_msgs/TFMessage", stamp,
                          test::transforms(cdr, stamp, {{"lidar", T_base_lidar}}, "base_link")});
    }
    test::writeBag(folder.file("x" + ending), messages);
    const auto bag = openBag(folder.file("x" + ending));
    EXPECT_TRUE(staticTransforms(*bag).empty());
    const RosTransforms constant = constantTransforms(*bag);
    ASSERT_EQ(constant.size(), 1U);
    EXPECT_EQ(constant.count("base_link"), 0U) << "it moves";
    EXPECT_TRUE(constant.at("lidar").pose.isApprox(T_base_lidar, 1e-9));
    EXPECT_EQ(sensorPosesOf(*bag, scanTopics(*bag)),
              "--sensor-pose '1 0 1.7 180 0 0'  (lidar in base_link, /tf, in which it is constant "
              "at first)\n");
  }
}

TEST(RosPoses, EveryTypeInBothSerialisations)
{
  const Pose pose = poseFromYpr(1, 2, 3, 0.5, -0.2, 0.1);
  for (const bool cdr : {false, true})
  {
    const auto check = [&](const std::string& type, const std::string& data, const char* child)
    {
      ASSERT_TRUE(isRosPose(topicOf(cdr, type)));
      const auto poses = decodeRosPoses(topicOf(cdr, type), messageOf(data));
      ASSERT_FALSE(poses.empty());
      EXPECT_NEAR(sweep_stamp, poses.back().stamp, 1e-6);
      EXPECT_EQ(child, poses.back().child);
      EXPECT_TRUE(poses.back().pose.isApprox(pose, 1e-12));
    };
    check("geometry_msgs/PoseStamped", test::poseStamped(cdr, sweep_stamp, pose), "");
    check("nav_msgs/Odometry", test::odometry(cdr, sweep_stamp, pose), "base_link");
    const std::string tf =
        test::transforms(cdr, sweep_stamp, {{"other", Pose::Identity()}, {"base_link", pose}});
    check("tf2_msgs/TFMessage", tf, "base_link");
    check("tf/tfMessage", tf, "base_link");
    EXPECT_EQ(2U, decodeRosPoses(topicOf(cdr, "tf2_msgs/TFMessage"), messageOf(tf)).size());
    EXPECT_FALSE(isRosPose(topicOf(cdr, "sensor_msgs/Imu")));

    const std::string data = test::odometry(cdr, sweep_stamp, pose);
    const auto message = messageOfError<UserError>(
        [&] {
          (void)decodeRosPoses(topicOf(cdr, "nav_msgs/Odometry"), messageOf(data.substr(0, 60)));
        });
    EXPECT_TRUE(contains(message, "short")) << message;
  }
  std::string zero = test::poseStamped(false, sweep_stamp, pose);
  std::fill(zero.end() - 32, zero.end(), '\0');
  std::size_t left_out = 0;
  const BagTopic topic = topicOf(false, "geometry_msgs/PoseStamped");
  EXPECT_TRUE(decodeRosPoses(topic, messageOf(zero), &left_out).empty());
  EXPECT_EQ(left_out, 1U);
}
}  // namespace dyslam
