// SPDX-License-Identifier: BSD-3-Clause
// Bags with scans and the samples of another sensor, for the tests of their conversion.
#pragma once

#include <dyslam/core/Frame.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SyntheticScans.h"

namespace dyslam
{
constexpr double begin_of_drive = 1600000000;  //!< [s]
constexpr double scan_period = 0.125;          //!< [s]
constexpr double sample_period = 0.03125;      //!< of IMU and odometry [s]
constexpr std::size_t drive_scans = 5;
constexpr std::size_t drive_samples = 100;  //!< from 2 s before the first scan

inline double scanStamp(std::size_t number)
{
  return begin_of_drive + scan_period * static_cast<double>(number);
}

inline double sampleStamp(std::size_t number)
{
  return begin_of_drive - 2 + sample_period * static_cast<double>(number);
}

using MessageOf = std::function<std::string(bool cdr, std::size_t number, double stamp)>;

/** A message with a scan of 40 points, with times and rings. */
inline std::string scanMessage(bool cdr, std::size_t number, const std::string& frame = "lidar")
{
  Scan scan = someScan(number, 40);
  for (std::size_t k = 0; k < scan.size(); ++k)
  {
    scan.time.push_back(1e-3F * static_cast<float>(k));
    scan.ring.push_back(static_cast<std::uint16_t>(k % 16));
  }
  return test::pointCloud2(cdr, scanStamp(number), test::velodyneFields(scan), 1, frame);
}

/** Scans that are received 0.1 s after their stamp, and samples of a topic that are at once. */
inline void writeDrive(const std::string& path,
                       const std::string& topic,
                       const std::string& type,
                       const MessageOf& messageOf,
                       const std::vector<std::pair<std::string, Pose>>& tf_static = {},
                       std::size_t samples = drive_samples,
                       const std::string& scan_frame = "lidar")
{
  const bool cdr = test::holdsCdr(path);
  std::vector<test::TestMessage> messages;
  if (!tf_static.empty())
  {
    const double stamp = sampleStamp(0);
    messages.push_back(
        {"/tf_static", "tf2_msgs/TFMessage", stamp, test::transforms(cdr, stamp, tf_static)});
  }
  for (std::size_t i = 0; i < drive_scans; ++i)
  {
    messages.push_back({"/points", "sensor_msgs/PointCloud2", scanStamp(i) + 0.1,
                        scanMessage(cdr, i, scan_frame)});
  }
  for (std::size_t i = 0; i < samples; ++i)
  {
    const double stamp = sampleStamp(i);
    messages.push_back({topic, type, stamp, messageOf(cdr, i, stamp)});
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  test::writeBag(path, messages);
}

inline std::string imuOfDrive(bool cdr, std::size_t number, double stamp)
{
  test::ImuValues values;
  values.angular_velocity.z() = static_cast<double>(number);
  values.acceleration = {0, 0, 9.81};
  return test::imu(cdr, stamp, values);
}

inline void writeImuDrive(const std::string& path,
                          const std::vector<std::pair<std::string, Pose>>& tf_static = {})
{
  writeDrive(path, "/imu/data", "sensor_msgs/Imu", imuOfDrive, tf_static);
}

/** The samples between the scans, each at or before the stamp of its scan; those of the first one
 * from 1 s before. */
template <typename Sample>
void expectInOrder(const std::vector<Frame>& frames, std::vector<Sample> Frame::*samples)
{
  double last = begin_of_drive - 1 - sample_period;
  for (const Frame& frame : frames)
  {
    for (const Sample& sample : frame.*samples)
    {
      EXPECT_NEAR(last + sample_period, sample.stamp, 1e-6);
      last = sample.stamp;
    }
    EXPECT_NEAR(frame.scan.stamp, last, 1e-6);
  }
}
}  // namespace dyslam
