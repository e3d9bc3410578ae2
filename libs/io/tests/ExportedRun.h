// SPDX-License-Identifier: BSD-3-Clause
// A small recording with a run on it, exported as a bag.
#pragma once

#include <dyslam/base/Error.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/BagExport.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam::test
{
inline constexpr std::size_t bag_scans = 4;
inline constexpr double bag_start = 1600000000;  // [s since 1970]

/** A scan with times, four rings and points without return. */
inline Scan timedScan(std::size_t number)
{
  Scan scan = someScan(number, 60 + number);
  scan.stamp = bag_start + 0.1 * static_cast<double>(number);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const auto ring = static_cast<std::uint16_t>(i % 4);
    scan.points[i] = {5 + 0.1F * static_cast<float>(i), 1, 0.5F * static_cast<float>(ring)};
    scan.ring.push_back(ring);
    scan.time.push_back(0.1F * static_cast<float>(i) / static_cast<float>(scan.size()));
  }
  scan.points[7].setConstant(std::numeric_limits<float>::quiet_NaN());
  scan.points[8].setZero();
  return scan;
}

/** Four scans with true poses, and samples of the other sensors. */
inline void writeSensors(const TestFolder& folder)
{
  RawlogWriter writer(folder.file("x.rawlog"));
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    const Scan scan = timedScan(i);
    ImuSample imu;
    imu.stamp = scan.stamp - 0.02;
    imu.angular_velocity = {0.1, 0.2, 0.3};
    imu.acceleration = Eigen::Vector3d(0.5, 0, 9.8);
    imu.T_vehicle_imu = poseFromYpr(0.2, 0, 0.4, 0.3, 0, 0);
    writer.write(imu);
    WheelSample wheels;
    wheels.stamp = scan.stamp - 0.01;
    wheels.forward_speed = 8;
    wheels.yaw_rate = 0.25;
    writer.write(wheels);
    GnssFix fix;
    fix.stamp = scan.stamp - 0.005;
    fix.position = {49.01, 8.4, 115};
    fix.horizontal_sigma = 1.5;
    fix.vertical_sigma = 3;
    fix.antenna = {-1, 0.1, 1.8};
    writer.write(fix);
    writer.write(scan, somePose(i));
  }
  writer.close();
}

/** Messages of a topic, in their order. */
struct TopicMessages
{
  BagTopic topic;
  std::vector<std::string> data;
  std::vector<double> times;
};

inline TopicMessages topicMessages(const std::string& path, const std::string& name)
{
  const auto bag = openBag(path);
  TopicMessages messages;
  for (std::size_t i = 0; i < bag->topics().size(); ++i)
  {
    if (bag->topics()[i].name == name)
    {
      messages.topic = bag->topics()[i];
      bag->select({i});
      for (BagMessage message; bag->next(message);)
      {
        messages.data.emplace_back(message.data);
        messages.times.push_back(message.recorded);
      }
    }
  }
  return messages;
}

inline std::vector<std::string> topicNames(const std::string& path)
{
  std::vector<std::string> names;
  const auto bag = openBag(path);
  for (const BagTopic& topic : bag->topics())
  {
    names.push_back(topic.name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

inline BagMessage bagMessage(const std::string& data)
{
  BagMessage message;
  message.data = data;
  message.place = "test";
  return message;
}

/** Poses of a topic that has one in each message. */
inline std::vector<RosPose> posesOf(const TopicMessages& messages)
{
  std::vector<RosPose> poses;
  for (const std::string& data : messages.data)
  {
    const auto read = decodeRosPoses(messages.topic, bagMessage(data));
    EXPECT_EQ(1U, read.size());
    poses.insert(poses.end(), read.begin(), read.end());
  }
  return poses;
}

inline Pose runPose(std::size_t i)
{
  return poseFromYpr(2, 1, 0, 0.5, 0, 0) * somePose(i);
}

/** The odometry has drifted by this against the map. */
inline const Pose drift_of_odometry = poseFromYpr(0.3, -0.2, 0.1, 0.05, 0, 0);

/** The folder of a run on the recording: trajectory, labels, an object of two scans, map. */
inline BagExportOptions writeRun(const TestFolder& folder)
{
  Trajectory poses;
  Trajectory odometry;
  std::vector<LabelledBox> boxes;
  std::string table =
      "frame,stamp,id,class,x,y,z,length,width,height,yaw,vx,vy,vz,speed,dynamic,"
      "observed,score\n";
  std::filesystem::create_directories(folder.file("run/labels"));
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    const Scan scan = timedScan(i);
    poses.push_back(scan.stamp, runPose(i));
    odometry.push_back(scan.stamp, drift_of_odometry.inverse() * runPose(i));
    std::vector<Label> labels(scan.size(), label_static);
    labels[2] = label_moving;
    labels[5] = makeLabel(252, 4);
    writeLabels(numberedPath(folder.file("run/labels"), i, ".label"), labels);
    if (i == 1 || i == 2)
    {
      LabelledBox box;
      box.frame = static_cast<int>(i);
      box.id = 3;
      box.type = "Car";
      box.box.centre = {10, 2, -0.5};
      box.box.size = {4, 1.8, 1.5};
      box.box.yaw = 0.3;
      boxes.push_back(box);
      table += std::to_string(i) + ",0,3,Car,0,0,0,4,1.8,1.5,0,6,8,0,10,1,1,0.9\n";
    }
  }
  writeTum(folder.file("run/trajectory_tum.txt"), poses);
  writeTum(folder.file("run/odometry_tum.txt"), odometry);
  writeTracks(folder.file("run/tracks.txt"), boxes);
  folder.write("run/tracks.csv", table);
  writePcd(folder.file("run/map_static.pcd"), {{1, 2, 3}, {4, 5, 6}}, {0.5F, 0.25F});
  BagExportOptions options;
  options.trajectory = folder.file("run/trajectory_tum.txt");
  options.labels = folder.file("run");
  options.tracks = folder.file("run/tracks.txt");
  options.map = folder.file("run/map_static.pcd");
  return options;
}

inline std::string exportError(const TestFolder& folder,
                               const BagExportOptions& options,
                               const std::string& output = "y.mcap")
{
  const auto message = messageOfError<UserError>(
      [&] { (void)exportBag(folder.file("x.rawlog"), folder.file(output), options); });
  EXPECT_FALSE(std::filesystem::exists(folder.file(output + ".tmp")));
  return message;
}
}  // namespace dyslam::test
