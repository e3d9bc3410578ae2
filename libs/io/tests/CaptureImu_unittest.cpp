// SPDX-License-Identifier: BSD-3-Clause
// The IMU in the Ouster of a capture, beside the scans of its rawlog.
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "SyntheticOuster.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::uint64_t millisecond = 1000000;  // [ns]

/** Four frames, and a packet of the IMU every 25 ms from 10 ms after the first column on. */
std::string ousterCapture(bool with_imu)
{
  const SyntheticOuster lidar;
  std::vector<std::string> packets;
  std::uint64_t time = lidar.first_time + 10 * millisecond;
  for (const std::string& packet : lidar.packetsOf(4))
  {
    packets.push_back(packet);
    if (with_imu)
    {
      packets.push_back(SyntheticOuster::imuPacket(time));
    }
    time += 25 * millisecond;
  }
  return SyntheticOuster::capture(packets);
}
}  // namespace

TEST(CaptureImu, SamplesStandBetweenTheScans)
{
  const TestFolder folder;
  folder.write("a.json", SyntheticOuster().metadata());
  const std::string capture = folder.write("a.pcap", ousterCapture(true));
  const std::string rawlog = folder.file("a.rawlog");
  ScanConverterOptions options;
  options.sensor_pose = "0.5 0 1.25 90 0 0";
  EXPECT_TRUE(hasLine(convertScans(capture, rawlog, options).notes,
                      "--imu adds the gyroscope of the OS-1-4"));
  for (const Frame& frame : readAll(rawlog))
  {
    EXPECT_TRUE(frame.imu.empty());
  }
  options.imu = true;
  const auto result = convertScans(capture, rawlog, options);
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_TRUE(
      hasLine(result.notes, "IMU: that of the OS-1-4, 12 samples; mounted as its metadata"));
  const auto frames = readAll(rawlog);
  ASSERT_EQ(4U, frames.size());
  EXPECT_TRUE(frames[0].imu.empty());
  Pose T_lidar_imu = Pose::Identity();
  T_lidar_imu.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  T_lidar_imu.translation() = Eigen::Vector3d(0.006, -0.012, 0.008);
  double stamp = 1000.01;
  for (std::size_t i = 1; i < frames.size(); ++i)
  {
    ASSERT_EQ(4U, frames[i].imu.size());
    for (const ImuSample& sample : frames[i].imu)
    {
      EXPECT_NEAR(stamp, sample.stamp, 1e-6);
      stamp += 0.025;
      EXPECT_TRUE(sample.angular_velocity.isApprox(Eigen::Vector3d(M_PI_2, -M_PI_4, M_PI), 1e-6));
      ASSERT_TRUE(sample.acceleration);
      EXPECT_NEAR(9.80665, sample.acceleration->z(), 1e-5);
      EXPECT_TRUE(sample.T_vehicle_imu.isApprox(
          poseFromYpr(0.5, 0, 1.25, M_PI_2, 0, 0) * T_lidar_imu, 1e-6));
    }
  }
}

TEST(CaptureImu, WithoutPacketsThereIsAWarning)
{
  const TestFolder folder;
  folder.write("a.json", SyntheticOuster().metadata());
  ScanConverterOptions options;
  options.imu = true;
  const auto result =
      convertScans(folder.write("a.pcap", ousterCapture(false)), folder.file("a.rawlog"), options);
  EXPECT_EQ(4U, result.scans);
  EXPECT_TRUE(hasLine(result.warnings, "has no sample of the IMU at the times of the scans: its"));
}

TEST(CaptureImu, WhatDoesNotFitIsAnError)
{
  const TestFolder folder;
  ScanConverterOptions options;
  options.imu = true;
  const auto message = [&](const std::string& input)
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(input, folder.file("a.rawlog"), options); });
  };
  const std::string velodyne = folder.write("v.pcap", captured(400));
  EXPECT_TRUE(contains(message(velodyne), "--imu reads the IMU of an Ouster, and this is a VLP16"));
  EXPECT_TRUE(contains(message(folder.write("a.bag", "")),
                       "--imu works with a .pcap or a lidar on the network only"));
  options.dt = 0.1;
  EXPECT_TRUE(contains(message(velodyne), "--imu and --dt exclude each other"));
}
}  // namespace dyslam
