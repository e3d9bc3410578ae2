// SPDX-License-Identifier: BSD-3-Clause
// Wheel odometry and satellite receiver of a bag beside the scans.
#include <dyslam/base/Error.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "MotionBags.h"
#include "TestFolder.h"

namespace dyslam
{
/** The velocities of wheels come later than those of the IMU. */
TEST(BagMotion, ScansWaitForBothSensors)
{
  const TestFolder folder;
  std::vector<test::TestMessage> messages;
  for (int i = -20; i < 60; ++i)
  {
    const double stamp = begin_of_drive + sample_period * i;
    messages.push_back({"/imu", "sensor_msgs/Imu", stamp, test::imu(false, stamp, {})});
    messages.push_back({"/speed", "geometry_msgs/TwistStamped", stamp + 0.5,
                        test::twistStamped(false, stamp, {2, 0, 0}, {0, 0, 0})});
  }
  messages.push_back({"/points", "sensor_msgs/PointCloud2", scanStamp(0), scanMessage(false, 0)});
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  test::writeBag(folder.file("x.bag"), messages);
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  options.odometry_topic = "/speed";
  (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(1U, frames.size());
  EXPECT_EQ(21U, frames[0].imu.size());
  EXPECT_EQ(21U, frames[0].wheels.size());
}

TEST(BagMotion, SpeedsOfEveryType)
{
  const TestFolder folder;
  const Eigen::Vector3d linear(8, 0.5, 0);
  const Eigen::Vector3d angular(0, 0, 0.25);
  struct Case
  {
    std::string type;
    MessageOf message;
  };
  const std::vector<Case> cases{
      {"nav_msgs/Odometry", [&](bool cdr, std::size_t, double stamp)
       { return test::odometry(cdr, stamp, Pose::Identity(), linear, angular); }},
      {"geometry_msgs/TwistStamped", [&](bool cdr, std::size_t, double stamp)
       { return test::twistStamped(cdr, stamp, linear, angular); }},
      {"geometry_msgs/TwistWithCovarianceStamped", [&](bool cdr, std::size_t, double stamp)
       { return test::twistStamped(cdr, stamp, linear, angular, true); }}};
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  for (const Case& one : cases)
  {
    for (const std::string ending : {".bag", ".mcap"})
    {
      writeDrive(folder.file("x" + ending), "/odom", one.type, one.message);
      const auto result = convertScans(folder.file("x" + ending), folder.file("x.rawlog"), options);
      EXPECT_TRUE(hasLine(result.notes, "wheel odometry: /odom, 49 samples")) << one.type;
      const auto frames = readAll(folder.file("x.rawlog"));
      expectInOrder(frames, &Frame::wheels);
      EXPECT_NEAR(8, frames.at(2).wheels.at(0).forward_speed, 1e-9);
      EXPECT_NEAR(0.25, frames[2].wheels[0].yaw_rate, 1e-9);
    }
  }
}

/** The vehicle is the lidar, which looks backwards 2 m before and 1 m to the left of base_link. */
TEST(BagMotion, SpeedsAreThoseOfTheVehiclesOrigin)
{
  const TestFolder folder;
  const auto message = [](bool cdr, std::size_t, double stamp) {
    return test::twistStamped(cdr, stamp, {8, 0, 0}, {0, 0, 0.5});
  };
  writeDrive(folder.file("x.bag"), "/odom", "geometry_msgs/TwistStamped", message,
             {{"base_link", Pose::Identity()}, {"lidar", poseFromYpr(2, 1, 0, M_PI, 0, 0)}});
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  const auto sample = [&]
  {
    (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
    return readAll(folder.file("x.rawlog")).at(1).wheels.at(0);
  };
  EXPECT_NEAR(-7.5, sample().forward_speed, 1e-9);
  EXPECT_NEAR(0.5, sample().yaw_rate, 1e-9);
  options.sensor_pose = "2 1 0 180 0 0";  // the vehicle is base_link
  EXPECT_NEAR(8, sample().forward_speed, 1e-9);
}

/** Drivers that fill in the pose alone. */
TEST(BagMotion, PosesReplaceVelocitiesThatAreAllZero)
{
  const TestFolder folder;
  const double speed = 4;
  const double yaw_rate = 0.5;
  const auto message = [&](bool cdr, std::size_t, double stamp)
  {
    const double time = stamp - sampleStamp(0);
    Vector6 motion = Vector6::Zero();
    motion[0] = speed * time;
    motion[5] = yaw_rate * time;
    return test::odometry(cdr, stamp, expSE3(motion));
  };
  writeDrive(folder.file("x.bag"), "/odom", "nav_msgs/Odometry", message);
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.notes, "velocities of /odom are all zero"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(drive_scans, frames.size());
  for (std::size_t i = 1; i < frames.size(); ++i)
  {
    ASSERT_EQ(4U, frames[i].wheels.size());
    EXPECT_NEAR(scanStamp(i) - 0.5 * sample_period, frames[i].wheels[3].stamp, 1e-6);
    EXPECT_NEAR(speed, frames[i].wheels[3].forward_speed, 1e-6);
    EXPECT_NEAR(yaw_rate, frames[i].wheels[3].yaw_rate, 1e-6);
  }
}

TEST(BagMotion, AVehicleThatStandsHasSpeedsOfZero)
{
  const TestFolder folder;
  const auto message = [](bool cdr, std::size_t, double stamp)
  { return test::odometry(cdr, stamp, poseFromYpr(1, 2, 0, 0.5, 0, 0)); };
  writeDrive(folder.file("x.bag"), "/odom", "nav_msgs/Odometry", message);
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_FALSE(hasLine(result.notes, "all zero"));
  EXPECT_NEAR(0, readAll(folder.file("x.rawlog")).at(1).wheels.at(0).forward_speed, 1e-9);
}

TEST(BagMotion, PositionsOfASatelliteReceiver)
{
  const TestFolder folder;
  const std::string rawlog = folder.file("x.rawlog");
  const Pose T_map_lidar = poseFromYpr(0, 0, 1, 0, 0, 0);
  const Pose T_map_gps = poseFromYpr(0.5, -0.25, 1.5, 0, 0, 0);
  const auto fixMessage = [](bool cdr, std::size_t number, double stamp)
  {
    test::FixValues values;
    values.latitude += 1e-5 * static_cast<double>(number);
    values.status = number % 10 == 9 ? -1 : 0;
    values.variance = number % 2 == 0 ? 2.25 : 0;
    return test::navSatFix(cdr, stamp, values);
  };
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    writeDrive(folder.file("x" + ending), "/fix", "sensor_msgs/NavSatFix", fixMessage,
               {{"lidar", T_map_lidar}, {"gps", T_map_gps}});
    ScanConverterOptions options;
    EXPECT_TRUE(hasLine(convertScans(folder.file("x" + ending), rawlog, options).notes,
                        "--gnss-topic adds the positions of a satellite receiver: /fix"));
    options.gnss_topic = "/fix";
    options.base_frame = "map";
    const auto result = convertScans(folder.file("x" + ending), rawlog, options);
    EXPECT_TRUE(
        hasLine(result.notes, "satellite receiver: /fix, 44 samples; antenna at the frame"));
    EXPECT_TRUE(hasLine(result.warnings, "10 messages without a fix left out"));
    std::size_t fixes = 0;
    for (const Frame& frame : readAll(rawlog))
    {
      for (const GnssFix& fix : frame.gnss)
      {
        ++fixes;
        const auto number = std::lround((fix.stamp - sampleStamp(0)) / sample_period);
        EXPECT_NE(9, number % 10);
        EXPECT_NEAR(49 + 1e-5 * static_cast<double>(number), fix.position.latitude, 1e-12);
        EXPECT_NEAR(8.4, fix.position.longitude, 1e-12);
        EXPECT_NEAR(115, fix.position.height, 1e-9);
        EXPECT_NEAR(number % 2 == 0 ? 1.5 : 0, fix.horizontal_sigma, 1e-6);
        EXPECT_NEAR(number % 2 == 0 ? 3 : 0, fix.vertical_sigma, 1e-6);
        EXPECT_TRUE(fix.antenna.isApprox(T_map_gps.translation(), 1e-6));
      }
    }
    EXPECT_EQ(44U, fixes);
  }
}

TEST(BagMotion, SwappedLatitudesAndLongitudesAreReported)
{
  const TestFolder folder;
  const auto fixMessage = [](bool cdr, std::size_t number, double stamp)
  {
    test::FixValues values;
    values.latitude = -122.4;
    values.longitude = 37.8;
    values.status = number % 10 == 9 ? -1 : 0;
    return test::navSatFix(cdr, stamp, values);
  };
  writeDrive(folder.file("x.mcap"), "/fix", "sensor_msgs/NavSatFix", fixMessage);
  ScanConverterOptions options;
  options.gnss_topic = "/fix";
  const auto result = convertScans(folder.file("x.mcap"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.warnings, "10 messages without a fix left out"));
  EXPECT_TRUE(hasLine(result.warnings, "90 messages with a latitude beyond 90 degrees left out"));
  EXPECT_TRUE(hasLine(result.warnings, "seems to swap latitude and longitude"));
}

TEST(BagMotion, Errors)
{
  const TestFolder folder;
  writeImuDrive(folder.file("x.bag"));
  ScanConverterOptions options;
  const auto message = [&](const std::string& name)
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(folder.file(name), folder.file("x.rawlog"), options); });
  };
  options.imu_topic = "/imu";
  EXPECT_TRUE(contains(message("x.bag"), "--imu-topic /imu is not in it; use /imu/data"));
  options.imu_topic = "/points";
  EXPECT_TRUE(contains(message("x.bag"), "sensor_msgs/PointCloud2 is not read; use /imu/data"));
  options.imu_topic = "";
  options.odometry_topic = "/imu/data";
  EXPECT_TRUE(contains(message("x.bag"),
                       "--odometry-topic /imu/data: sensor_msgs/Imu is not read; --list shows"));
  options = {};
  options.imu_pose = "0 0 0 0 0 0";
  EXPECT_TRUE(contains(message("x.bag"), "--imu-topic is mounted; give that, too"));
  options.imu_topic = "/imu/data";
  options.imu_pose = "1 2";
  EXPECT_TRUE(contains(message("x.bag"), "--imu-pose '1 2': six numbers"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog")));
  options = {};
  options.imu_topic = "/imu";
  folder.write("scans/000000.bin", "");
  EXPECT_TRUE(contains(message("scans"), "--imu-topic works with a bag or topics of ROS 2 only"));
}
}  // namespace dyslam
