// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosWriter.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/BagExport.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "DecodedMessage.h"
#include "FullDisk.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::size_t bag_scans = 4;
constexpr double bag_start = 1600000000;  // [s since 1970]

/** A scan with times, four rings and points without return. */
Scan timedScan(std::size_t number)
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
void writeSensors(const TestFolder& folder)
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

TopicMessages topicMessages(const std::string& path, const std::string& name)
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

std::vector<std::string> topicNames(const std::string& path)
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

test::DecodedMessage decodedAs(RosType type, const std::string& data)
{
  return {rosTypeName(type), rosDefinition(type), data};
}

BagMessage bagMessage(const std::string& data)
{
  BagMessage message;
  message.data = data;
  message.place = "test";
  return message;
}

/** Poses of a topic that has one in each message. */
std::vector<RosPose> posesOf(const TopicMessages& messages)
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

Pose runPose(std::size_t i)
{
  return poseFromYpr(2, 1, 0, 0.5, 0, 0) * somePose(i);
}

/** The odometry has drifted by this against the map. */
const Pose drift_of_odometry = poseFromYpr(0.3, -0.2, 0.1, 0.05, 0, 0);

/** The folder of a run on the recording: trajectory, labels, an object of two scans, map. */
BagExportOptions writeRun(const TestFolder& folder)
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

std::string exportError(const TestFolder& folder,
                        const BagExportOptions& options,
                        const std::string& output = "y.mcap")
{
  const auto message = messageOfError<UserError>(
      [&] { (void)exportBag(folder.file("x.rawlog"), folder.file(output), options); });
  EXPECT_FALSE(std::filesystem::exists(folder.file(output + ".tmp")));
  return message;
}
}  // namespace

TEST(BagExport, ARecordingThereAndBackAgain)
{
  const TestFolder folder;
  writeSensors(folder);
  const auto there = exportBag(folder.file("x.rawlog"), folder.file("bags/x.mcap"), {});
  EXPECT_EQ(bag_scans, there.scans);
  EXPECT_EQ(bag_scans, there.poses);
  EXPECT_EQ("the rawlog", there.pose_source);
  EXPECT_TRUE(there.warnings.empty());
  EXPECT_EQ((std::vector<std::string>{"/gnss", "/ground_truth", "/imu", "/points", "/tf",
                                      "/tf_static", "/wheels"}),
            topicNames(folder.file("bags/x.mcap")));

  ScanConverterOptions back;
  back.base_frame = "base_link";
  back.imu_topic = "/imu";
  back.odometry_topic = "/wheels";
  back.gnss_topic = "/gnss";
  back.truth_topic = "/ground_truth";
  const auto result = convertScans(folder.file("bags/x.mcap"), folder.file("y.rawlog"), back);
  EXPECT_TRUE(hasLine(result.notes, "per-point time: field time, seconds from the time stamp"));
  EXPECT_TRUE(hasLine(result.notes, "the vehicle is base_link"));
  const auto before = readAll(folder.file("x.rawlog"));
  const auto after = readAll(folder.file("y.rawlog"));
  ASSERT_EQ(bag_scans, after.size());
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    EXPECT_TRUE(samePoints(before[i].scan, after[i].scan));
    EXPECT_NEAR(before[i].scan.stamp, after[i].scan.stamp, 1e-6);
    EXPECT_EQ(before[i].scan.intensity, after[i].scan.intensity);
    EXPECT_EQ(before[i].scan.ring, after[i].scan.ring);
    EXPECT_EQ(before[i].scan.time, after[i].scan.time);
    EXPECT_TRUE(before[i].scan.T_vehicle_lidar.isApprox(after[i].scan.T_vehicle_lidar, 1e-9));
    ASSERT_TRUE(after[i].T_world_vehicle_truth.has_value());
    EXPECT_TRUE(after[i].T_world_vehicle_truth->isApprox(somePose(i), 1e-6));
    ASSERT_EQ(1U, after[i].imu.size());
    EXPECT_NEAR(before[i].imu[0].stamp, after[i].imu[0].stamp, 1e-6);
    EXPECT_TRUE(before[i].imu[0].angular_velocity.isApprox(after[i].imu[0].angular_velocity));
    ASSERT_TRUE(after[i].imu[0].acceleration.has_value());
    EXPECT_TRUE(before[i].imu[0].acceleration->isApprox(*after[i].imu[0].acceleration));
    EXPECT_TRUE(before[i].imu[0].T_vehicle_imu.isApprox(after[i].imu[0].T_vehicle_imu, 1e-6));
    ASSERT_EQ(1U, after[i].wheels.size());
    EXPECT_NEAR(8, after[i].wheels[0].forward_speed, 1e-9);
    EXPECT_NEAR(0.25, after[i].wheels[0].yaw_rate, 1e-9);
    ASSERT_EQ(1U, after[i].gnss.size());
    EXPECT_NEAR(49.01, after[i].gnss[0].position.latitude, 1e-9);
    EXPECT_NEAR(1.5, after[i].gnss[0].horizontal_sigma, 1e-6);
    EXPECT_TRUE(after[i].gnss[0].antenna.isApprox(before[i].gnss[0].antenna, 1e-6));
  }
}

TEST(BagExport, TransformsPlaceSensorsAndVehicle)
{
  const TestFolder folder;
  writeSensors(folder);
  (void)exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), {});
  const auto fixed = topicMessages(folder.file("x.mcap"), "/tf_static");
  ASSERT_EQ(1U, fixed.data.size());
  const auto sensors = decodeRosPoses(fixed.topic, bagMessage(fixed.data[0]));
  ASSERT_EQ(3U, sensors.size());
  for (const RosPose& sensor : sensors)
  {
    EXPECT_EQ("base_link", sensor.parent);
    const Pose expected = sensor.child == "lidar" ? timedScan(0).T_vehicle_lidar
                          : sensor.child == "imu" ? poseFromYpr(0.2, 0, 0.4, 0.3, 0, 0)
                                                  : poseFromYpr(-1, 0.1, 1.8, 0, 0, 0);
    EXPECT_TRUE(expected.isApprox(sensor.pose, 1e-6)) << sensor.child;
  }
  const auto tf = posesOf(topicMessages(folder.file("x.mcap"), "/tf"));
  ASSERT_EQ(bag_scans, tf.size());
  EXPECT_EQ("world", tf[2].parent);
  EXPECT_EQ("base_link", tf[2].child);
  EXPECT_TRUE(somePose(2).isApprox(tf[2].pose, 1e-6));
}

TEST(BagExport, MessagesAreInTheOrderOfTime)
{
  const TestFolder folder;
  writeSensors(folder);
  (void)exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), writeRun(folder));
  const auto bag = openBag(folder.file("x.mcap"));
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < bag->topics().size(); ++i)
  {
    all.push_back(i);
  }
  bag->select(all);
  double last = 0;
  std::vector<std::string> first;
  for (BagMessage message; bag->next(message);)
  {
    EXPECT_GE(message.recorded, last);
    last = message.recorded;
    first.push_back(bag->topics()[message.topic].name);
  }
  EXPECT_EQ("/tf_static", first.at(0)) << "before all that it places";
  EXPECT_EQ("/imu", first.at(1));
  EXPECT_EQ("/wheels", first.at(2));
  EXPECT_EQ("/gnss", first.at(3));
  EXPECT_EQ("/tf", first.at(4));
  const auto imu = topicMessages(folder.file("x.mcap"), "/imu");
  ASSERT_EQ(bag_scans, imu.times.size());
  EXPECT_NEAR(bag_start + 0.1 - 0.02, imu.times[1], 1e-6);
}

TEST(BagExport, TheResultsOfARun)
{
  const TestFolder folder;
  writeSensors(folder);
  const auto result = exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), writeRun(folder));
  EXPECT_EQ(bag_scans, result.poses);
  EXPECT_EQ(bag_scans, result.label_files);
  EXPECT_EQ(2U, result.boxes);
  EXPECT_EQ(folder.file("run/trajectory_tum.txt"), result.pose_source);
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();

  const auto tf = posesOf(topicMessages(folder.file("x.mcap"), "/tf"));
  const auto truth = posesOf(topicMessages(folder.file("x.mcap"), "/ground_truth"));
  ASSERT_EQ(bag_scans, tf.size());
  ASSERT_EQ(bag_scans, truth.size());
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    EXPECT_EQ("map", tf[i].parent);
    EXPECT_TRUE(runPose(i).isApprox(tf[i].pose, 1e-9));
    EXPECT_EQ("map", truth[i].parent);
    EXPECT_TRUE(runPose(i).isApprox(truth[i].pose, 1e-6)) << "moved as a whole";
  }
  const auto path = topicMessages(folder.file("x.mcap"), "/path");
  ASSERT_EQ(1U, path.data.size());
  EXPECT_EQ(bag_scans, decodedAs(RosType::path, path.data[0]).count("poses"));

  const auto map = topicMessages(folder.file("x.mcap"), "/map");
  ASSERT_EQ(1U, map.data.size());
  EXPECT_NEAR(bag_start, map.times[0], 1e-6);
  RosScanDecoder decoder;
  const Scan points = decoder.decode(map.topic, bagMessage(map.data[0]));
  EXPECT_EQ((std::vector<Eigen::Vector3f>{{1, 2, 3}, {4, 5, 6}}), points.points);
  EXPECT_EQ((std::vector<float>{0.5F, 0.25F}), points.intensity);
  EXPECT_EQ("map", decodedAs(RosType::point_cloud2, map.data[0]).text("header.frame_id"));
}

TEST(BagExport, TheOdometryHasTheVelocityInTheVehiclesAxes)
{
  const TestFolder folder;
  writeSensors(folder);
  (void)exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), writeRun(folder));
  const auto odometry = topicMessages(folder.file("x.mcap"), "/odometry");
  ASSERT_EQ(bag_scans, odometry.data.size());
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    const auto twist = decodeRosTwist(odometry.topic, bagMessage(odometry.data[i]));
    ASSERT_TRUE(twist.has_value());
    EXPECT_EQ("base_link", twist->frame);
    // That of the first scan is of the motion after it.
    const std::size_t to = std::max<std::size_t>(i, 1);
    Vector6 step;
    step << 0.1 * twist->linear, 0.1 * twist->angular;
    EXPECT_TRUE((runPose(to - 1) * expSE3(step)).isApprox(runPose(to), 1e-4)) << i;
  }
}

TEST(BagExport, LabelsMarkTheMovingPoints)
{
  const TestFolder folder;
  writeSensors(folder);
  (void)exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), writeRun(folder));
  const auto all = topicMessages(folder.file("x.mcap"), "/points");
  const auto rest = topicMessages(folder.file("x.mcap"), "/points_static");
  ASSERT_EQ(bag_scans, all.data.size());
  ASSERT_EQ(bag_scans, rest.data.size());
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    const Scan scan = timedScan(i);
    const auto message = decodedAs(RosType::point_cloud2, all.data[i]);
    ASSERT_EQ(scan.size(), message.number("width"));
    EXPECT_EQ("moving", message.text("fields[6].name"));
    const std::string points = message.text("data");
    const auto step = static_cast<std::size_t>(message.number("point_step"));
    const auto offset = static_cast<std::size_t>(message.number("fields[6].offset"));
    for (std::size_t j = 0; j < scan.size(); ++j)
    {
      EXPECT_EQ(j == 2 || j == 5 ? 1 : 0, points[j * step + offset]) << j;
    }
    RosScanDecoder decoder;
    const Scan read = decoder.decode(rest.topic, bagMessage(rest.data[i]));
    ASSERT_EQ(scan.size() - 2, read.size());
    EXPECT_EQ(scan.points[3], read.points[2]);
    EXPECT_EQ(scan.points.back(), read.points.back());
    EXPECT_EQ(scan.ring.back(), read.ring.back());
  }
}

TEST(BagExport, ObjectsAreInTheMapFrame)
{
  const TestFolder folder;
  writeSensors(folder);
  (void)exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), writeRun(folder));
  const auto objects = topicMessages(folder.file("x.mcap"), "/objects");
  ASSERT_EQ(bag_scans, objects.data.size())
      << "also of scans without objects: they delete the last";
  EXPECT_EQ(1U, decodedAs(RosType::marker_array, objects.data[0]).count("markers"));
  const auto markers = decodedAs(RosType::marker_array, objects.data[2]);
  ASSERT_EQ(4U, markers.count("markers")) << "deletion, arrow, box, name";
  const Pose T_map_lidar = runPose(2) * timedScan(2).T_vehicle_lidar;
  const Eigen::Vector3d centre = T_map_lidar * Eigen::Vector3d(10, 2, -0.5);
  const auto vectorAt = [&](const std::string& path)
  {
    return Eigen::Vector3d(markers.number(path + ".x"), markers.number(path + ".y"),
                           markers.number(path + ".z"));
  };
  EXPECT_EQ("map", markers.text("markers[2].header.frame_id"));
  EXPECT_EQ("boxes", markers.text("markers[2].ns"));
  EXPECT_EQ(3, markers.number("markers[2].id"));
  EXPECT_TRUE(centre.isApprox(vectorAt("markers[2].pose.position"), 1e-5));
  EXPECT_TRUE(Eigen::Vector3d(4, 1.8, 1.5).isApprox(vectorAt("markers[2].scale"), 1e-5));
  // The file's yaw is of the box as it was taken to the lidar.
  Box box;
  box.centre = {10, 2, -0.5};
  box.yaw = 0.3;
  const double yaw = transformedBack(box, T_map_lidar.inverse()).yaw;
  EXPECT_NEAR(std::sin(yaw / 2), markers.number("markers[2].pose.orientation.z"), 1e-5);
  EXPECT_TRUE(centre.isApprox(vectorAt("markers[1].points[0]"), 1e-5));
  const Eigen::Vector3d velocity = drift_of_odometry.linear() * Eigen::Vector3d(6, 8, 0);
  EXPECT_TRUE((centre + velocity).isApprox(vectorAt("markers[1].points[1]"), 1e-5));
  EXPECT_EQ("3 Car 10.0 m/s", markers.text("markers[3].text"));
}

TEST(BagExport, ObjectsWithoutTheTableOfTheRunHaveNoVelocities)
{
  const TestFolder folder;
  writeSensors(folder);
  const BagExportOptions options = writeRun(folder);
  std::filesystem::remove(folder.file("run/odometry_tum.txt"));
  const auto result = exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), options);
  EXPECT_TRUE(hasLine(result.warnings, "odometry_tum.txt of the run is not beside it"));
  const auto markers =
      decodedAs(RosType::marker_array, topicMessages(folder.file("x.mcap"), "/objects").data.at(1));
  ASSERT_EQ(3U, markers.count("markers")) << "deletion, box, name";
  EXPECT_EQ("3 Car", markers.text("markers[2].text"));
}

TEST(BagExport, ScansAreChosen)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options = writeRun(folder);
  options.static_only = true;
  options.source.skip_first_n = 1;
  options.source.only_first_n = 2;
  const auto result = exportBag(folder.file("x.rawlog"), folder.file("a.mcap"), options);
  EXPECT_EQ(2U, result.scans);
  EXPECT_EQ(timedScan(1).size() + timedScan(2).size() - 4, result.points) << "without the moving";
  EXPECT_EQ(2U, result.boxes);
  const auto names = topicNames(folder.file("a.mcap"));
  EXPECT_EQ(0, std::count(names.begin(), names.end(), "/points"));
  const auto rest = topicMessages(folder.file("a.mcap"), "/points_static");
  ASSERT_EQ(2U, rest.data.size());
  EXPECT_EQ(timedScan(1).size() - 2,
            decodedAs(RosType::point_cloud2, rest.data[0]).number("width"));
  const auto path = topicMessages(folder.file("a.mcap"), "/path");
  EXPECT_EQ(bag_scans, decodedAs(RosType::path, path.data.at(0)).count("poses")) << "the whole";

  options.static_only = false;
  options.no_scans = true;
  EXPECT_EQ(0U, exportBag(folder.file("x.rawlog"), folder.file("b.mcap"), options).points);
  const auto without = topicNames(folder.file("b.mcap"));
  EXPECT_EQ((std::vector<std::string>{"/gnss", "/ground_truth", "/imu", "/map", "/objects",
                                      "/odometry", "/path", "/tf", "/tf_static", "/wheels"}),
            without);
}

TEST(BagExport, TheSameInputGivesTheSameBytes)
{
  const TestFolder folder;
  writeSensors(folder);
  const BagExportOptions options = writeRun(folder);
  (void)exportBag(folder.file("x.rawlog"), folder.file("a.mcap"), options);
  (void)exportBag(folder.file("x.rawlog"), folder.file("b.mcap"), options);
  EXPECT_TRUE(folder.read("a.mcap") == folder.read("b.mcap"));
}

TEST(BagExport, ScansWithoutAPoseAreSaid)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options;
  Trajectory poses;
  poses.push_back(timedScan(0).stamp, runPose(0));
  poses.push_back(timedScan(1).stamp, runPose(1));
  writeTum(folder.file("two.txt"), poses);
  options.trajectory = folder.file("two.txt");
  const auto result = exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), options);
  EXPECT_EQ(2U, result.poses);
  EXPECT_EQ(2U, topicMessages(folder.file("x.mcap"), "/tf").data.size());
  EXPECT_EQ(bag_scans, topicMessages(folder.file("x.mcap"), "/points").data.size());
  EXPECT_TRUE(hasLine(result.warnings, "two.txt: has no pose for 2 of 4 scans"));
  EXPECT_TRUE(hasLine(result.warnings,
                      "(scans: 1600000000.000 to 1600000000.300 s, "
                      "poses: 1600000000.000 to 1600000000.100 s)"));

  Trajectory other;
  other.push_back(5, runPose(0));
  other.push_back(6, runPose(1));
  writeTum(folder.file("other.txt"), other);
  options.trajectory = folder.file("other.txt");
  const std::string none = exportError(folder, options);
  EXPECT_TRUE(contains(none, "other.txt: has no pose for any scan"));
  EXPECT_TRUE(contains(none, "poses: 5.000 to 6.000 s)")) << none;
  EXPECT_FALSE(std::filesystem::exists(folder.file("y.mcap")));
}

TEST(BagExport, WhatDoesNotFitIsSaid)
{
  const TestFolder folder;
  writeSensors(folder);
  const BagExportOptions run = writeRun(folder);
  EXPECT_TRUE(contains(exportError(folder, run, "y.bag"), "y.bag: name the bag to write *.mcap"));
  BagExportOptions options;
  options.tracks = run.tracks;
  EXPECT_TRUE(contains(exportError(folder, options), "give --trajectory"));
  options = {};
  options.map = run.map;
  EXPECT_TRUE(contains(exportError(folder, options), "--map " + run.map));
  options = {};
  options.static_only = true;
  EXPECT_TRUE(contains(exportError(folder, options), "--static-only: needs labels"));
  options.labels = run.labels;
  options.no_scans = true;
  EXPECT_TRUE(contains(exportError(folder, options), "--no-scans leaves all out"));
  options = {};
  options.trajectory = folder.file("kitti.txt");
  writeKittiPoses(options.trajectory, std::vector<Pose>{runPose(0)});
  EXPECT_TRUE(contains(exportError(folder, options), "kitti.txt: has no times"));
  options = {};
  options.labels = folder.path();
  EXPECT_TRUE(contains(exportError(folder, options), "is not a folder of .label files"));
  options.labels = folder.file("run");
  std::filesystem::remove(folder.file("run/labels/000002.label"));
  const std::string unlabelled = exportError(folder, options);
  EXPECT_TRUE(contains(unlabelled, "000002.label: no such file, but scan 2"));
  EXPECT_TRUE(contains(unlabelled, "(--only-first-n 2)")) << unlabelled;
  options.source.skip_first_n = 1;
  EXPECT_TRUE(contains(exportError(folder, options), "(--skip-first-n 1 --only-first-n 1)"));
  options.source.skip_first_n = 2;
  EXPECT_TRUE(contains(exportError(folder, options), "(--skip-first-n, --only-first-n)"));
  options = {};
  options.source.skip_first_n = 9;
  EXPECT_TRUE(contains(exportError(folder, options), "skip_first_n = 9: no scan is left"));
}

TEST(BagExport, PosesThatRosDoesNotHoldNameTheirFile)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options;
  Trajectory poses;
  poses.push_back(-0.05, runPose(0));
  poses.push_back(timedScan(0).stamp, runPose(0));
  writeTum(folder.file("early.txt"), poses);
  options.trajectory = folder.file("early.txt");
  EXPECT_TRUE(
      contains(exportError(folder, options),
               folder.file("early.txt") + ": the time stamp -0.050 s is none that ROS 2 holds"));
}

TEST(BagExport, ADiskThatIsFullIsNoFaultOfTheMap)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options = writeRun(folder);
  // More than a chunk, so that the map is written at once.
  std::vector<Eigen::Vector3f> points(500000);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    points[i] = {static_cast<float>(i), std::sin(static_cast<float>(i)), 1};
  }
  writePcd(options.map, points, std::vector<float>(points.size(), 0.5F));
  const test::FullDisk disk(10000);
  const std::string error = exportError(folder, options);
  EXPECT_EQ(0U, error.find(folder.file("y.mcap") + ": cannot be written")) << error;
  EXPECT_FALSE(contains(error, "--no-map")) << error;
}

TEST(BagExport, AfterDamageTheScansBeforeCanBeChosen)
{
  const TestFolder folder;
  RawlogWriter writer(folder.file("whole.rawlog"));
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    writer.write(timedScan(i), somePose(i));
  }
  writer.close();
  const std::string whole = folder.read("whole.rawlog");
  folder.write("x.rawlog", whole.substr(0, whole.size() - 16));
  BagExportOptions options;
  options.source.skip_first_n = 1;
  const std::string error = exportError(folder, options);
  EXPECT_TRUE(contains(error, "is cut short")) << error;
  const std::string advice = "; the scans before it can be written with --skip-first-n 1 ";
  ASSERT_TRUE(contains(error, advice + "--only-first-n 2")) << error;
  options.source.only_first_n = 2;
  EXPECT_EQ(2U, exportBag(folder.file("x.rawlog"), folder.file("y.mcap"), options).scans);
}

TEST(BagExport, NothingOfOthersIsTouchedAndNothingHalfStays)
{
  const TestFolder folder;
  writeSensors(folder);
  folder.write("y.mcap", "earlier");
  EXPECT_TRUE(contains(exportError(folder, {}), "y.mcap: is there already"));
  BagExportOptions options;
  options.force = true;
  const auto stop = [](double, std::size_t scans)
  {
    if (scans == 2)
    {
      throw std::runtime_error("stop");
    }
  };
  EXPECT_THROW((void)exportBag(folder.file("x.rawlog"), folder.file("y.mcap"), options, stop),
               std::runtime_error);
  EXPECT_EQ("earlier", folder.read("y.mcap"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("y.mcap.tmp")));
  (void)exportBag(folder.file("x.rawlog"), folder.file("y.mcap"), options);
  EXPECT_EQ(bag_scans, topicMessages(folder.file("y.mcap"), "/points").data.size());
}
}  // namespace dyslam
