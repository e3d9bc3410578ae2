// SPDX-License-Identifier: BSD-3-Clause
#include "../src/recording/LateStamps.h"

#include <dyslam/io/Converters.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::size_t points = 40;

/** A scan every 0.125 s, with 1 ms between its points and 39 ms in all. \param first time of the
 * first point after the stamp [s] */
Scan scanFrom(std::size_t number, float first)
{
  Scan scan = someScan(number, points);
  scan.stamp = 1600000000 + 0.125 * static_cast<double>(number);
  for (std::size_t i = 0; i < points; ++i)
  {
    scan.time.push_back(first + 1e-3F * static_cast<float>(i));
    scan.ring.push_back(static_cast<std::uint16_t>(i % 16));
  }
  return scan;
}
}  // namespace

TEST(LateStamps, LateIsBehindThreeQuartersOfTheScan)
{
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(firstOfLateStamp({}), std::nullopt);
  EXPECT_EQ(firstOfLateStamp({nan, nan}), std::nullopt);
  EXPECT_EQ(firstOfLateStamp({-0.5F, nan, -0.5F}), std::nullopt);
  EXPECT_EQ(firstOfLateStamp({0.0F, 1.0F}), 0.0) << "of the first point";
  EXPECT_EQ(firstOfLateStamp({-0.5F, 0.5F}), 0.0) << "of the middle";
  EXPECT_EQ(firstOfLateStamp({-0.75F, 0.25F}), 0.0);
  EXPECT_EQ(firstOfLateStamp({nan, 0.125F, -0.875F}), -0.875);
  EXPECT_EQ(firstOfLateStamp({-1.0F, 0.0F}), -1.0) << "of the last point";
  EXPECT_EQ(firstOfLateStamp({-1.5F, -0.5F}), -1.5) << "of the arrival";
  EXPECT_EQ(firstOfLateStamp({0.0F, -1e6F, 1.0F}), 0.0) << "one is damaged";
}

TEST(LateStamps, AllMoveByTheTimeOfTheFirstScans)
{
  LateStamps late;
  Scan without_times = someScan(0, 3);
  late(without_times);
  EXPECT_EQ(without_times.stamp, 100.0);
  Scan scan;
  scan.stamp = 10;
  scan.time = {-0.5F, -0.25F, 0.0F};
  late(scan);
  EXPECT_EQ(scan.stamp, 9.5);
  EXPECT_EQ(scan.time, (std::vector<float>{0.0F, 0.25F, 0.5F}));
  scan.stamp = 11;
  scan.time = {-0.25F, 0.0F};
  late(scan);
  EXPECT_EQ(scan.stamp, 10.5);
  EXPECT_EQ(scan.time, (std::vector<float>{0.25F, 0.5F}));
  scan.stamp = 12;
  scan.time = {-1.0F, 0.0F};
  late(scan);
  EXPECT_EQ(scan.stamp, 11.5);
  EXPECT_EQ(scan.time, (std::vector<float>{-0.5F, 0.5F}));
  EXPECT_TRUE(hasLine(late.notes(), "moved by 0.500000 s to the first points"));
}

TEST(LateStamps, TheFirstScanMayBeAPart)
{
  LateStamps late;
  Scan scan;
  scan.stamp = 10;
  scan.time = {-0.125F, 0.0F};
  late(scan);
  EXPECT_EQ(scan.stamp, 9.875);
  scan.stamp = 11;
  scan.time = {-1.0F, 0.0F};
  late(scan);
  EXPECT_EQ(scan.stamp, 10.0);
  EXPECT_EQ(scan.time, (std::vector<float>{0.0F, 1.0F}));
}

TEST(LateStamps, OthersStay)
{
  LateStamps late;
  Scan scan;
  scan.stamp = 10;
  scan.time = {0.0F, 0.5F};
  late(scan);
  late(scan);
  scan.time = {-0.5F, 0.0F};
  late(scan);
  EXPECT_EQ(scan.stamp, 10.0);
  EXPECT_EQ(scan.time, (std::vector<float>{-0.5F, 0.0F}));
  EXPECT_TRUE(late.notes().empty());
}

/** As the drivers of Velodyne and RoboSense give it by default. */
TEST(LateStamps, BagsWithTheStampOfTheLastPoint)
{
  const TestFolder folder;
  std::vector<test::TestMessage> messages;
  for (std::size_t i = 0; i < 4; ++i)
  {
    const Scan scan = scanFrom(i, -0.039F);
    messages.push_back({"/points", "sensor_msgs/PointCloud2", scan.stamp,
                        test::pointCloud2(false, scan.stamp, test::velodyneFields(scan))});
    const Pose pose = poseFromYpr(static_cast<double>(i), 0, 0, 0, 0, 0);
    messages.push_back({"/pose", "geometry_msgs/PoseStamped", scan.stamp,
                        test::poseStamped(false, scan.stamp, pose)});
  }
  test::writeBag(folder.file("x.bag"), messages);
  ScanConverterOptions options;
  options.truth_topic = "/pose";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.notes, "time stamps: late in the scans; moved by 0.039"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(frames.size(), 4U);
  for (const Frame& frame : frames)
  {
    const auto n = static_cast<double>(frame.index);
    EXPECT_NEAR(frame.scan.stamp, 1600000000 - 0.039 + 0.125 * n, 1e-6);
    ASSERT_EQ(frame.scan.time.size(), points);
    EXPECT_NEAR(frame.scan.time.front(), 0.0F, 1e-6F);
    EXPECT_NEAR(frame.scan.time.back(), 0.039F, 1e-6F);
    ASSERT_EQ(frame.T_world_vehicle_truth.has_value(), frame.index > 0);
    if (frame.index > 0)
    {
      EXPECT_NEAR(frame.T_world_vehicle_truth->translation().x(), n - 0.039 / 0.125, 1e-4);
    }
  }
}

TEST(LateStamps, ARawlogWithThemIsWarnedOf)
{
  const TestFolder folder;
  const auto areWarnedOf = [&](float first)
  {
    const std::string path = folder.file(std::to_string(first) + ".rawlog");
    {
      RawlogWriter writer(path);
      writer.write(scanFrom(0, first));
      writer.write(scanFrom(1, first));
      writer.close();
    }
    RawlogSource source(path);
    const auto frames = framesOf(source);
    EXPECT_EQ(frames.size(), 2U);
    EXPECT_NEAR(frames.back().scan.stamp, 1600000000.125, 1e-6);
    return hasLine(source.warnings(), "time stamps are late in the scans");
  };
  EXPECT_TRUE(areWarnedOf(-0.039F));
  EXPECT_FALSE(areWarnedOf(-0.02F));
  EXPECT_FALSE(areWarnedOf(0));
}
}  // namespace dyslam
