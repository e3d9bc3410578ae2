// SPDX-License-Identifier: BSD-3-Clause
#include "../src/recording/LateStamps.h"

#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "MotionBytes.h"
#include "RosMessageWriters.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::size_t points = 40;
constexpr std::size_t scans = 5;
constexpr double late_by = 0.039;  //!< time of the last point after the first [s]

double stampOf(std::size_t number)
{
  return 1600000000 + 0.125 * static_cast<double>(number);
}

/** A scan every 0.125 s, with 1 ms between its points and 39 ms in all. \param first time of the
 * first point after the stamp [s] */
Scan scanFrom(std::size_t number, float first)
{
  Scan scan = someScan(number, points);
  scan.stamp = stampOf(number);
  for (std::size_t i = 0; i < points; ++i)
  {
    scan.time.push_back(first + 1e-3F * static_cast<float>(i));
    scan.ring.push_back(static_cast<std::uint16_t>(i % 16));
  }
  return scan;
}

/** Scans at constant speed with true poses, and before each the samples up to its stamp: of an IMU
 * every 25 ms, of wheels and satellite receiver every 125 ms.
 * \param delay of the stamps [s] \param first time of the first point after the stamp [s] */
void writeDrive(const std::string& path, double delay, float first)
{
  RawlogWriter writer(path);
  std::size_t samples = 0;
  for (std::size_t i = 0; i < scans; ++i)
  {
    Scan scan = scanFrom(i, first);
    scan.stamp += delay;
    for (;; ++samples)
    {
      const double stamp = stampOf(0) - 0.005 + 0.025 * static_cast<double>(samples);
      if (stamp > scan.stamp)
      {
        break;
      }
      writer.write(test::imuSample(stamp));
      if (samples % 5 == 0)
      {
        writer.write(WheelSample{stamp, 4, 0});
        GnssFix fix;
        fix.stamp = stamp;
        fix.position = {48, 9, 300};
        writer.write(fix);
      }
    }
    writer.write(scan, poseFromYpr(8 * (scan.stamp - stampOf(0)), 0, 0, 0, 0, 0));
  }
  writer.close();
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

TEST(LateStamps, TimesThatAreAllTheSameAreNotExaminedForever)
{
  LateStamps late;
  for (int i = 0; i < 20; ++i)
  {
    EXPECT_FALSE(late.isKnown());
    late.examine({});
    late.examine({0.0F, 0.0F});
  }
  EXPECT_TRUE(late.isKnown());
  EXPECT_EQ(late.shift(), 0);
}

TEST(LateStamps, ThoseOfARawlogAreMoved)
{
  const TestFolder folder;
  const auto areMoved = [&](float first)
  {
    const std::string path = folder.file(std::to_string(first) + ".rawlog");
    writeDrive(path, 0, first);
    RawlogSource source(path);
    const auto frames = framesOf(source);
    EXPECT_EQ(frames.size(), scans);
    const bool has_note = hasLine(
        source.warnings(), "time stamps of 'velodyne' are late in the scans: moved by 0.039000 s");
    EXPECT_EQ(source.warnings().size(), has_note ? 1U : 0U);
    EXPECT_NEAR(frames.back().scan.stamp, stampOf(scans - 1) - (has_note ? 0.039 : 0), 1e-6);
    EXPECT_NEAR(frames.back().scan.time.front(), has_note ? 0 : first, 1e-6);
    return has_note;
  };
  EXPECT_TRUE(areMoved(-0.039F));
  EXPECT_FALSE(areMoved(-0.02F));
  EXPECT_FALSE(areMoved(0));
}

/** Motion samples and true poses come with the scans as if their stamps had never been late. */
TEST(LateStamps, FramesAreThoseOfStampsOfTheFirstPoint)
{
  const TestFolder folder;
  writeDrive(folder.file("early.rawlog"), 0, 0);
  writeDrive(folder.file("late.rawlog"), late_by, -0.039F);
  const auto early = readAll(folder.file("early.rawlog"));
  const auto late = readAll(folder.file("late.rawlog"));
  ASSERT_EQ(early.size(), scans);
  ASSERT_EQ(late.size(), scans);
  for (std::size_t i = 0; i < scans; ++i)
  {
    EXPECT_NEAR(late[i].scan.stamp, early[i].scan.stamp, 1e-6);
    ASSERT_EQ(late[i].scan.time.size(), points);
    for (std::size_t k = 0; k < points; ++k)
    {
      EXPECT_NEAR(late[i].scan.time[k], early[i].scan.time[k], 1e-6F);
    }
    ASSERT_EQ(late[i].imu.size(), early[i].imu.size());
    ASSERT_EQ(late[i].wheels.size(), 1U);
    ASSERT_EQ(late[i].gnss.size(), 1U);
    for (std::size_t k = 0; k < early[i].imu.size(); ++k)
    {
      EXPECT_EQ(late[i].imu[k].stamp, early[i].imu[k].stamp);
      EXPECT_LE(late[i].imu[k].stamp, late[i].scan.stamp);
    }
    EXPECT_EQ(late[i].wheels[0].stamp, early[i].wheels[0].stamp);
    EXPECT_EQ(late[i].gnss[0].stamp, early[i].gnss[0].stamp);
    ASSERT_TRUE(early[i].T_world_vehicle_truth);
    ASSERT_EQ(late[i].T_world_vehicle_truth.has_value(), i > 0) << "none before the first";
    if (i > 0)
    {
      EXPECT_NEAR(late[i].T_world_vehicle_truth->translation().x(),
                  early[i].T_world_vehicle_truth->translation().x(), 1e-4);
    }
  }
}

/** Programs that read different parts of a recording have the same stamps. */
TEST(LateStamps, SkippedScansCount)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (std::size_t i = 0; i < 5; ++i)
    {
      writer.write(scanFrom(i, i == 1 ? -0.039F : -0.038F));
    }
    writer.close();
  }
  const auto all = readAll(folder.file("a.rawlog"));
  ASSERT_EQ(all.size(), 5U);
  EXPECT_NEAR(all[0].scan.stamp, stampOf(0) - 0.038, 1e-6);
  EXPECT_NEAR(all[1].scan.stamp, stampOf(1) - 0.039, 1e-6);
  const auto firstOf = [&](const RawlogSourceOptions& options)
  { return RawlogSource(folder.file("a.rawlog"), options).next()->scan.stamp; };
  RawlogSourceOptions options;
  options.skip_first_n = 3;
  EXPECT_EQ(firstOf(options), all[3].scan.stamp);
  options.skip_first_n = 0;
  options.start = all[2].scan.stamp - all[0].scan.stamp;
  EXPECT_EQ(firstOf(options), all[2].scan.stamp);
}

TEST(LateStamps, FurtherLidarsHaveTheirOwn)
{
  const TestFolder folder;
  const auto partsOf = [&](float first, float first_of_rear)
  {
    const std::string path = folder.file("both.rawlog");
    {
      RawlogWriter writer(path);
      for (std::size_t i = 0; i < scans; ++i)
      {
        // The rear lidar begins 10 ms after the front one and is written after it.
        Scan front = scanFrom(i, first);
        Scan rear = scanFrom(i, first_of_rear);
        front.sensor_label = "front";
        rear.sensor_label = "rear";
        rear.T_vehicle_lidar = Pose::Identity();
        front.stamp -= static_cast<double>(first);
        rear.stamp += 0.01 - static_cast<double>(first_of_rear);
        writer.write(front);
        writer.write(rear);
      }
      writer.close();
    }
    RawlogSourceOptions options;
    options.further_lidars = "rear";
    RawlogSource source(path, options);
    const auto frames = framesOf(source);
    EXPECT_EQ(frames.size(), scans);
    for (const Frame& frame : frames)
    {
      EXPECT_NEAR(frame.scan.stamp, stampOf(frame.index), 1e-6);
      EXPECT_EQ(frame.scan.parts.size(), 1U);
      EXPECT_NEAR(frame.scan.parts.at(0).stamp, 0.01, 1e-6);
      EXPECT_NEAR(frame.scan.time.at(points), 0.01F, 1e-6F) << "the rear lidar's first point";
      EXPECT_NEAR(frame.scan.time.back(), 0.049F, 1e-6F);
    }
    return source.warnings().size();
  };
  EXPECT_EQ(partsOf(0, 0), 0U);
  EXPECT_EQ(partsOf(0, -0.039F), 1U);
  EXPECT_EQ(partsOf(-0.039F, 0), 1U);
  EXPECT_EQ(partsOf(-0.039F, -0.039F), 2U);
}

/** Their scans are read, too, before they are used. */
TEST(LateStamps, DamageIsReportedAtItsScan)
{
  const TestFolder folder;
  RawlogWriterOptions options;
  options.external_storage = true;
  {
    RawlogWriter writer(folder.file("a.rawlog"), options);
    for (std::size_t i = 0; i < 4; ++i)
    {
      writer.write(scanFrom(i, -0.039F));
    }
    writer.close();
  }
  ASSERT_TRUE(std::filesystem::remove(folder.file("a_Images/velodyne_000000.gz")));
  EXPECT_THROW((void)readAll(folder.file("a.rawlog")), UserError);
  RawlogSourceOptions later;
  later.skip_first_n = 1;
  RawlogSource source(folder.file("a.rawlog"), later);
  const auto frames = framesOf(source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_NEAR(frames[0].scan.stamp, stampOf(1) - 0.039, 1e-6);
}
}  // namespace dyslam
