// SPDX-License-Identifier: BSD-3-Clause
// ROS bags of the table of inputs in doc/formats.md: the same drive gives the same trajectory from
// every container, and the programs say what to do with a bag.
#include <dyslam/core/Frame.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "BagWriters.h"
#include "ConvertedDrive.h"
#include "RosMessageWriters.h"
#include "RunProgram.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
class BagInputs : public test::ConvertedDrive
{
 protected:
  /** The drive as messages, scans on /points and true poses on /odom. \param cdr those of ROS 2 */
  static std::vector<test::TestMessage> messages(bool cdr)
  {
    std::vector<test::TestMessage> all;
    for (std::size_t i = 0; i < test::drive_scans; ++i)
    {
      const double stamp = scans_[i].stamp;
      all.push_back({"/points", "sensor_msgs/PointCloud2", stamp,
                     test::pointCloud2(cdr, stamp, test::velodyneFields(scans_[i]))});
      all.push_back({"/odom", "nav_msgs/Odometry", stamp, test::odometry(cdr, stamp, poses_[i])});
    }
    return all;
  }
  /** Writes the messages to a bag. \param name its ending tells the format \return its path */
  static std::string bag(const std::string& name)
  {
    fs::create_directories((folder_ / name).parent_path());
    test::writeBag(at(name), messages(test::holdsCdr(name)));
    return at(name);
  }
};

TEST_F(BagInputs, Ros1Ros2AndMcapGiveTheTrajectoryOfTheRawlog)
{
  const std::string expected = slam(at("original.rawlog"), "run");
  ASSERT_FALSE(expected.empty());
  std::vector<std::string> bytes;
  for (const std::string name : {"drive.bag", "drive.db3", "drive.mcap"})
  {
    const auto frames =
        converted("scans2rawlog", "-i " + bag(name) + " --topic /points --truth-topic /odom",
                  {"scans: /points", "per-point time: field time", "ring: field ring"});
    expectOriginal(frames);
    for (std::size_t i = 0; i < frames.size(); ++i)
    {
      EXPECT_EQ(scans_[i].time, frames[i].scan.time);
      EXPECT_EQ(scans_[i].ring, frames[i].scan.ring);
      EXPECT_TRUE(frames[i].T_world_vehicle_truth->isApprox(poses_[i], 1e-9));
    }
    bytes.push_back(contentOf(at("out.rawlog")));
    EXPECT_EQ(expected, slam(at("out.rawlog"), "run_" + name)) << name;
  }
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[0], bytes[2]);
}

TEST_F(BagInputs, AFolderOfARos2Recording)
{
  write("recording/metadata.yaml", "rosbag2_bagfile_information:\n");
  expectOriginal(
      (bag("recording/recording_0.db3"), converted("scans2rawlog", "-i " + at("recording"))));
}

TEST_F(BagInputs, LivoxMessagesInABag)
{
  std::vector<test::TestMessage> all;
  for (Scan scan : scans_)
  {
    std::fill(scan.intensity.begin(), scan.intensity.end(), 51.F);
    for (float& time : scan.time)
    {
      time = std::max(time, 0.F);
    }
    all.push_back({"/livox/lidar", "livox_ros_driver2/CustomMsg", scan.stamp,
                   test::livoxMessage(true, scan)});
  }
  test::writeBag(at("livox.mcap"), all);
  const auto frames = converted("scans2rawlog", "-i " + at("livox.mcap"), {"field offset_time"});
  ASSERT_EQ(test::drive_scans, frames.size());
  EXPECT_EQ(scans_[3].points, frames[3].scan.points);
  EXPECT_FLOAT_EQ(0.2F, frames[3].scan.intensity[7]);
}

TEST_F(BagInputs, TopicsOfABag)
{
  for (const std::string name : {"drive.bag", "drive.db3", "drive.mcap"})
  {
    const Outcome outcome = run("scans2rawlog", "--list -i " + bag(name));
    EXPECT_EQ(0, outcome.code);
    EXPECT_NE(outcome.out.find("/points  sensor_msgs/PointCloud2         6"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("nav_msgs/Odometry"), std::string::npos);
    EXPECT_NE(outcome.out.find("duration 0.50 s"), std::string::npos);
  }
}

/** Beside a depth camera with more scans and points, the lidar is chosen, whose points have rings
 * and times. */
TEST_F(BagInputs, TheLidarIsTakenAmongOtherScans)
{
  std::vector<test::TestMessage> all;
  for (std::size_t i = 0; i < 2 * test::drive_scans; ++i)
  {
    const Scan& scan = scans_[i / 2];
    const double stamp = scan.stamp + 0.01 * static_cast<double>(i % 2);
    const std::vector<double> zeros(2 * scan.size(), 0.0);
    all.push_back(
        {"/depth", "sensor_msgs/PointCloud2", stamp,
         test::pointCloud2(true, stamp, {{"x", 7, zeros}, {"y", 7, zeros}, {"z", 7, zeros}})});
    if (i % 2 == 0)
    {
      all.push_back({"/points", "sensor_msgs/PointCloud2", stamp,
                     test::pointCloud2(true, stamp, test::velodyneFields(scan))});
    }
  }
  Pose mounting = Pose::Identity();
  mounting.translation() = Eigen::Vector3d(0.8, 0, 1.7);
  all.push_back({"/tf_static", "tf2_msgs/TFMessage", scans_[0].stamp,
                 test::transforms(true, scans_[0].stamp, {{"lidar", mounting}})});
  test::writeBag(at("two.mcap"), all);
  expectOriginal(converted("scans2rawlog", "-i " + at("two.mcap"),
                           {"scans: /points", "--topic chooses other scans: /depth"}));
  const Outcome list = run("scans2rawlog", "--list -i " + at("two.mcap"));
  EXPECT_NE(list.out.find(std::to_string(scans_[0].size()) + "  lidar  <- taken without --topic\n"),
            std::string::npos)
      << list.out;
  EXPECT_NE(list.out.find("--sensor-pose '0.8 0 1.7 0 0 0'  (lidar in map, /tf_static)"),
            std::string::npos)
      << list.out;

  for (const Scan& scan : scans_)
  {
    all.push_back({"/rear", "sensor_msgs/PointCloud2", scan.stamp,
                   test::pointCloud2(true, scan.stamp, test::velodyneFields(scans_[0]))});
  }
  test::writeBag(at("three.mcap"), all);
  const Outcome three = run("scans2rawlog", "-q -i " + at("three.mcap") + " -o " + at("o.rawlog"));
  EXPECT_NE(three.err.find("warning: the scans of /"), std::string::npos) << three.err;
  EXPECT_NE(three.err.find("--topic chooses others: /"), std::string::npos) << three.err;
}

TEST_F(BagInputs, ATruthTopicOfOnePoseIsNamed)
{
  auto all = messages(true);
  all.push_back({"/pose", "geometry_msgs/PoseStamped", scans_[0].stamp,
                 test::poseStamped(true, scans_[0].stamp, poses_[0])});
  test::writeBag(at("pose.mcap"), all);
  const Outcome outcome =
      run("scans2rawlog",
          "-q -i " + at("pose.mcap") + " --truth-topic /pose --force -o " + at("o.rawlog"));
  EXPECT_EQ(1, outcome.code);
  EXPECT_NE(outcome.err.find("/pose has only one pose"), std::string::npos) << outcome.err;
}

TEST_F(BagInputs, ProgramsThatReadRawlogsSayWhatToDoWithABag)
{
  for (const std::string name : {"drive.bag", "drive.db3", "drive.mcap"})
  {
    const std::string path = bag(name);
    for (const auto& [program, arguments] : std::vector<std::pair<std::string, std::string>>{
             {"dyslam-map", "--trajectory t.txt -o " + at("never.pcd") + " -i "},
             {"kitti2rawlog", "--kind raw -o " + at("never.rawlog") + " -i "},
             {"rawlog2bag", "-o " + at("never.mcap") + " -i "},
             {"rawlog2kitti", "-o " + at("never") + " -i "},
             {"dyslam-eval", "trajectory --reference " + path + " --estimate "},
             {"dyslam-eval", "map --reference " + path + " --estimate "}})
    {
      const Outcome outcome = run(program, arguments + path);
      EXPECT_EQ(1, outcome.code) << program;
      EXPECT_EQ(1, std::count(outcome.err.begin(), outcome.err.end(), '\n')) << outcome.err;
      EXPECT_NE(outcome.err.find("scans2rawlog -i " + path + " -o drive.rawlog"), std::string::npos)
          << program << ": " << outcome.err;
    }
  }
  EXPECT_FALSE(fs::exists(at("never")));
}
}  // namespace
}  // namespace dyslam
