// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosWriter.h>
#include <dyslam/io/BagExport.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "DecodedMessage.h"
#include "ExportedRun.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::bag_scans;
using test::bag_start;
using test::bagMessage;
using test::drift_of_odometry;
using test::posesOf;
using test::runPose;
using test::timedScan;
using test::topicMessages;
using test::topicNames;
using test::writeRun;
using test::writeSensors;

test::DecodedMessage decodedAs(RosType type, const std::string& data)
{
  return {rosTypeName(type), rosDefinition(type), data};
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

/** Of a run whose odometry is along x of the vehicle, which the map sees turned. */
TEST(BagExport, TheOdometryHasTheCovariancesOfTheRun)
{
  const TestFolder folder;
  writeSensors(folder);
  BagExportOptions options = writeRun(folder);
  std::string motions = motionFileHeader();
  for (std::size_t i = 0; i < bag_scans; ++i)
  {
    MotionCovariance motion;
    motion.stamp = timedScan(i).stamp;
    motion.covariance(0, 0) = i == 0 ? 0 : 4e-4;  // along x
    motion.covariance(5, 5) = i == 0 ? 0 : 1e-6;  // about z
    motions += motionFileRow(motion);
  }
  options.motions = folder.write("run/motions.csv", motions);
  const auto matrixOf = [&](std::size_t scan, const std::string& of)
  {
    options.force = true;
    (void)exportBag(folder.file("x.rawlog"), folder.file("x.mcap"), options);
    const auto odometry = topicMessages(folder.file("x.mcap"), "/odometry");
    const auto message = decodedAs(RosType::odometry, odometry.data.at(scan));
    Matrix6 matrix;
    for (int i = 0; i < 36; ++i)
    {
      matrix(i / 6, i % 6) = message.number(of + ".covariance[" + std::to_string(i) + "]");
    }
    return matrix;
  };
  EXPECT_TRUE(matrixOf(0, "pose").isZero(0)) << "the first pose is that of the map";
  const Eigen::Vector3d x = runPose(1).linear().col(0);
  const Eigen::Vector3d z = runPose(1).linear().col(2);
  const Matrix6 pose = matrixOf(1, "pose");
  EXPECT_TRUE((pose.topLeftCorner<3, 3>().isApprox(4e-4 * x * x.transpose(), 1e-6))) << pose;
  EXPECT_TRUE((pose.bottomRightCorner<3, 3>().isApprox(1e-6 * z * z.transpose(), 1e-6))) << pose;
  EXPECT_GT(matrixOf(3, "pose").trace(), 2 * pose.trace());
  for (const std::size_t scan : {0U, 2U})
  {
    Matrix6 twist = Matrix6::Zero();
    twist(0, 0) = 4e-2;  // in 0.1 s
    twist(5, 5) = 1e-4;
    EXPECT_TRUE(matrixOf(scan, "twist").isApprox(twist, 1e-3)) << scan;
  }

  Trajectory corrected = readTum(folder.file("run/trajectory_tum.txt"));
  Trajectory other;
  for (std::size_t i = 0; i < corrected.size(); ++i)
  {
    const Pose loop = poseFromYpr(0.01 * static_cast<double>(i), 0, 0, 0, 0, 0);
    other.push_back(corrected[i].stamp, loop * corrected[i].pose);
  }
  writeTum(folder.file("run/trajectory_tum.txt"), other);
  EXPECT_TRUE(matrixOf(3, "pose").isZero(0)) << "not that of the odometry any more";
  EXPECT_FALSE(matrixOf(3, "twist").isZero(0));
  options.motions.clear();
  EXPECT_TRUE(matrixOf(3, "twist").isZero(0));
}

/** By the frame `map`, which other programs use for their results, too. */
TEST(BagExport, TheOdometryOfARunIsNeitherASensorNorTrue)
{
  const TestFolder folder;
  writeSensors(folder);
  const std::string bag = folder.file("x.mcap");
  (void)exportBag(folder.file("x.rawlog"), bag, writeRun(folder));
  const std::string listing = listingOf(*openBag(bag));
  const auto rowOf = [&listing](const std::string& topic)
  {
    const auto at = listing.find("\n" + topic + " ");
    return at == std::string::npos ? "" : listing.substr(at + 1, listing.find('\n', at + 1) - at);
  };
  EXPECT_TRUE(contains(rowOf("/odometry"), "map  <- result of a SLAM, no wheel odometry"))
      << listing;
  EXPECT_TRUE(contains(rowOf("/wheels"), "<- for --odometry-topic")) << listing;

  const auto warningsWith = [&](const std::string& odometry, const std::string& truth)
  {
    ScanConverterOptions options;
    options.base_frame = "base_link";
    options.odometry_topic = odometry;
    options.truth_topic = truth;
    return convertScans(bag, folder.file("y.rawlog"), options).warnings;
  };
  EXPECT_TRUE(hasLine(warningsWith("/odometry", ""), "/odometry: is in the frame 'map'"));
  for (const std::string truth : {"/odometry", "/tf"})
  {
    EXPECT_TRUE(hasLine(warningsWith("", truth), truth + ": is in the frame 'map': if it is"))
        << truth;
  }
  EXPECT_FALSE(hasLine(warningsWith("/wheels", "/ground_truth"), "in the frame 'map'"));
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
}  // namespace dyslam
