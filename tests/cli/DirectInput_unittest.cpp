// SPDX-License-Identifier: BSD-3-Clause
// dyslam on a recording that is no rawlog gives the same results as on the converted recording.
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "RunProgram.h"
#include "SyntheticCapture.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
class DirectInput : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 600;
    options.seed = 5;
    sim::Simulator simulator(options, 1);
    for (std::size_t i = 0; i < 6; ++i)
    {
      auto simulated = simulator.next();
      simulated.scan.stamp += 1.6e9;  // bags count from 1970
      scans_.push_back(simulated.scan);
      poses_.push_back(static_cast<double>(i), simulated.T_map_vehicle);
    }
  }
  static void TearDownTestSuite()
  {
    scans_.clear();
    poses_ = {};
  }

  [[nodiscard]] std::string at(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] Outcome run(const std::string& program, const std::string& arguments) const
  {
    return runProgram(program, arguments, folder_.path());
  }

  void bins(const std::string& name) const
  {
    fs::create_directories(at(name));
    for (std::size_t i = 0; i < scans_.size(); ++i)
    {
      writeCloud(at(name + "/00000" + std::to_string(i) + ".bin"), scans_[i].points,
                 scans_[i].intensity);
    }
  }

  /** Writes a bag with two topics of scans: /points and /rear. */
  void bag(const std::string& name) const
  {
    std::vector<test::TestMessage> all;
    for (const Scan& scan : scans_)
    {
      for (const char* topic : {"/points", "/rear"})
      {
        const Scan& content = topic == std::string("/points") ? scan : scans_[0];
        all.push_back({topic, "sensor_msgs/PointCloud2", scan.stamp,
                       test::pointCloud2(true, scan.stamp, test::velodyneFields(content))});
      }
    }
    fs::create_directories(fs::path(at(name)).parent_path());
    test::writeBag(at(name), all);
  }

  /** Runs the converter and then dyslam, and dyslam alone, and compares the results. \param flags
   * flags of both dyslam and the converter */
  void expectSameAsConvertedFirst(const std::string& converter,
                                  const std::string& input,
                                  const std::string& flags = "")
  {
    const std::string given = " -i " + at(input) + " " + flags;
    ASSERT_EQ(0, run(converter, given + " -q -o " + at("first.rawlog") + " --force").code);
    const Outcome expected =
        run("dyslam", "-q --force -i " + at("first.rawlog") + " -o " + at("first"));
    const Outcome direct = run("dyslam", given + " -o " + at("direct_" + input));
    EXPECT_EQ(expected.code, direct.code) << input << '\n' << direct.err;
    const std::string out = "direct_" + input + "/";
    EXPECT_FALSE(folder_.read("first/trajectory_tum.txt").empty()) << expected.err;
    EXPECT_EQ(folder_.read("first/trajectory_tum.txt"), folder_.read(out + "trajectory_tum.txt"));
    EXPECT_EQ(folder_.read("first.rawlog"), folder_.read(out + "recording.rawlog"));
    EXPECT_EQ(folder_.read("first.gt/poses_tum.txt"),
              folder_.read(out + "recording.gt/poses_tum.txt"));
    EXPECT_TRUE(contains(folder_.read(out + "recording.ini"), "input = " + at(input)));
    EXPECT_TRUE(contains(direct.err, "dyslam, conversion: 100%")) << direct.err;
    EXPECT_TRUE(contains(direct.out, out + "recording.rawlog stays")) << direct.out;
    EXPECT_TRUE(contains(direct.out, converter + " converts with more options\n")) << direct.out;
  }

  static std::ptrdiff_t lines(const std::string& text)
  {
    return std::count(text.begin(), text.end(), '\n');
  }

  /** Expects an error. \param says parts of the only line on stderr */
  void expectRefused(const std::string& arguments, const std::vector<std::string>& says)
  {
    const Outcome outcome = run("dyslam", arguments);
    EXPECT_EQ(1, outcome.code) << arguments << '\n' << outcome.err;
    EXPECT_EQ(1, std::count(outcome.err.begin(), outcome.err.end(), '\n')) << outcome.err;
    for (const std::string& part : says)
    {
      EXPECT_TRUE(contains(outcome.err, part)) << part << "\nnot in\n" << outcome.err;
    }
  }

  TestFolder folder_;
  static std::vector<Scan> scans_;
  static Trajectory poses_;
};
std::vector<Scan> DirectInput::scans_;
Trajectory DirectInput::poses_;
}  // namespace

TEST_F(DirectInput, AFolderOfScans)
{
  bins("scans");
  expectSameAsConvertedFirst("scans2rawlog", "scans", "--dt 0.2 --sensor-pose '0 0 1.7 0 0 0'");
}

TEST_F(DirectInput, ScansInMillimetres)
{
  const std::vector<Scan> in_metres = scans_;
  for (Scan& scan : scans_)
  {
    for (Eigen::Vector3f& point : scan.points)
    {
      point *= 1000;
    }
  }
  bins("scans");
  scans_ = in_metres;
  expectSameAsConvertedFirst("scans2rawlog", "scans", "--scale 0.001");
  EXPECT_TRUE(contains(folder_.read("direct_scans/report.json"), "0.1 s between scans is assumed"))
      << "a warning of the conversion";
  for (const std::string scale : {"0", "-1", "nan", "mm"})
  {
    expectRefused("-i " + at("scans") + " -o " + at("never") + " --scale " + scale,
                  {"--scale", scale});
  }
}

TEST_F(DirectInput, AConvertedRecordingKeepsTheWarningsOfItsConversion)
{
  bins("scans");
  ASSERT_EQ(0, run("dyslam", "-q -i " + at("scans") + " -o " + at("run")).code);
  const std::string warning =
      "conversion of " + at("scans") + ": the scans have no times: 0.1 s between scans is assumed";
  const Outcome again = run("dyslam", "-i " + at("run/recording.rawlog") + " -o " + at("again"));
  EXPECT_EQ(0, again.code) << again.err;
  EXPECT_TRUE(contains(again.err, "warning: " + warning)) << again.err;
  EXPECT_TRUE(contains(folder_.read("again/report.json"), warning));
}

TEST_F(DirectInput, ABag)
{
  bag("drive.mcap");
  expectSameAsConvertedFirst("scans2rawlog", "drive.mcap", "--topic /points");
}

/** The recordings of all lidars of a vehicle, merged without a setting. */
TEST_F(DirectInput, ABagOfSeveralLidars)
{
  const Pose T_lidar_rear = poseFromYpr(-1, 0, 0, M_PI, 0, 0);
  const double begin = scans_[0].stamp;
  std::vector<test::TestMessage> all{
      {"/tf_static", "tf2_msgs/TFMessage", begin,
       test::transforms(true, begin, {{"lidar", Pose::Identity()}, {"rear_lidar", T_lidar_rear}})}};
  const Eigen::Isometry3f T_rear_lidar = T_lidar_rear.inverse().cast<float>();
  for (const Scan& scan : scans_)
  {
    Scan rear = scan;
    for (auto& p : rear.points)
    {
      p = T_rear_lidar * p;
    }
    for (const auto& [frame, content] :
         {std::pair("lidar", &scan), std::pair("rear_lidar", &std::as_const(rear))})
    {
      all.push_back(
          {std::string("/") + frame + "/points", "sensor_msgs/PointCloud2", scan.stamp,
           test::pointCloud2(true, scan.stamp, test::velodyneFields(*content), 1, frame)});
    }
  }
  test::writeBag(at("two.mcap"), all);
  const Outcome outcome =
      run("dyslam", "-i " + at("two.mcap") + " -o " + at("run") +
                        " --topic /lidar/points --further-topic /rear_lidar/points --labels");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "further lidar: /rear_lidar/points")) << outcome.err;
  EXPECT_TRUE(contains(folder_.read("run/effective.ini"), "further_lidars = rear_lidar_points"));
  EXPECT_EQ(fs::file_size(at("run/labels/000003.label")), 2 * 4 * scans_[3].size());
  EXPECT_TRUE(contains(folder_.read("run/scan_parts.csv"), "\n3,rear_lidar_points,"));
  EXPECT_TRUE(contains(folder_.read("run/report.html"),
                       "\"further_lidars\":[{\"label\":\"rear_lidar_points\",\"scans\":"));
}

TEST_F(DirectInput, InABatch)
{
  bag("all/drive.mcap");
  bins("all/drive_sync/velodyne_points/data");
  const std::string command = at("all") + " -o " + at("batch") + " --no-summary";
  const Outcome outcome = run("dyslam-batch", command);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "drive: done")) << outcome.out;
  EXPECT_TRUE(contains(outcome.out, "drive_sync: done")) << outcome.out;
  const Outcome single = run("dyslam", "-q -i " + at("all/drive.mcap") + " -o " + at("single"));
  EXPECT_EQ(single.code, 0) << single.err;
  EXPECT_FALSE(folder_.read("single/trajectory_tum.txt").empty());
  EXPECT_EQ(folder_.read("single/trajectory_tum.txt"),
            folder_.read("batch/drive/trajectory_tum.txt"));
  EXPECT_TRUE(contains(run("dyslam-batch", command).out, "drive: done before"));
  const Outcome other = run("dyslam-batch", at("all/drive.mcap") + " -o " + at("other") +
                                                " --no-summary --topic=/nothing");
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(contains(other.out, "/nothing is not in it")) << other.out;

  const std::string rest = " -o " + at("mixed") + " --no-summary ";
  const std::string rawlog = at("single/recording.rawlog");
  const Outcome unfit = run("dyslam-batch", at("all") + rest + "--topic /points");
  EXPECT_EQ(unfit.code, 1);
  EXPECT_TRUE(contains(unfit.err,
                       at("all/drive_sync") + ": --topic works with a bag or topics of ROS 2 only"))
      << unfit.err;
  const Outcome unused = run("dyslam-batch", rawlog + rest + "--dt 0.2");
  EXPECT_EQ(unused.code, 1);
  EXPECT_TRUE(contains(unused.err, "--dt: is for recordings that are converted")) << unused.err;
  EXPECT_FALSE(fs::exists(at("mixed")));
  const Outcome mixed =
      run("dyslam-batch", at("all/drive_sync") + " " + rawlog + rest + "--dt 0.2");
  EXPECT_EQ(mixed.code, 0) << mixed.out << mixed.err;
}

TEST_F(DirectInput, ACapture)
{
  folder_.write("drive.pcap", captured(400));
  expectSameAsConvertedFirst("scans2rawlog", "drive.pcap");
}

TEST_F(DirectInput, KittiFolders)
{
  bins("drive_sync/velodyne_points/data");
  writeKittiPoses(at("drive_sync/poses.txt"), poses_);
  expectSameAsConvertedFirst("kitti2rawlog --kind raw", "drive_sync");
  EXPECT_FALSE(folder_.read("direct_drive_sync/recording.gt/poses_tum.txt").empty());

  const std::string of_360 = "2013_05_28_drive_0000_sync";
  bins(of_360 + "/velodyne_points/data");
  folder_.write(of_360 + "/calib_cam_to_velo.txt", "0 0 1 0 -1 0 0 0 0 -1 0 0\n");
  folder_.write(of_360 + "/calib_cam_to_pose.txt", "image_00: 0 0 1 0 1 0 0 0 0 1 0 0\n");
  folder_.write(of_360 + "/poses.txt", "1 1 0 0 5 0 -1 0 6 0 0 -1 7\n");
  expectSameAsConvertedFirst("kitti2rawlog --kind 360", of_360);
  EXPECT_FALSE(folder_.read("direct_" + of_360 + "/recording.gt/poses_tum.txt").empty());
}

TEST_F(DirectInput, ARerunConvertsAgain)
{
  bins("scans");
  const std::string words = "-q -i " + at("scans") + " -o " + at("run");
  ASSERT_EQ(0, run("dyslam", words).code);
  const std::string earlier = folder_.read("run/recording.rawlog");
  fs::remove(at("scans/000005.bin"));
  const Outcome again = run("dyslam", words);
  EXPECT_EQ(0, again.code) << again.err;
  EXPECT_NE(earlier, folder_.read("run/recording.rawlog"));

  fs::remove(at("run/recording.ini"));  // now the folder holds a recording that no run wrote
  expectRefused(words, {"run/recording.rawlog: is there already", "--force"});
  EXPECT_EQ(0, run("dyslam", words + " --force").code);
}

TEST_F(DirectInput, OnlyThePartThatIsUsedIsConverted)
{
  bag("drive.mcap");
  const std::string part = "-i " + at("drive.mcap") + " --topic /points --skip-first-n 1 ";
  ASSERT_EQ(0, run("scans2rawlog", "-q " + part + "--only-first-n 3 -o " + at("part.rawlog")).code);
  const std::string in_run = part + "--set input.only_first_n=3 -o " + at("run");
  const Outcome first = run("dyslam", in_run);
  EXPECT_EQ(0, first.code) << first.err;
  EXPECT_EQ(folder_.read("part.rawlog"), folder_.read("run/recording.rawlog"));
  EXPECT_EQ(3, lines(folder_.read("run/trajectory_tum.txt")));
  EXPECT_TRUE(contains(first.out,
                       "run/recording.rawlog has only this part of the recording "
                       "(--skip-first-n 1 --only-first-n 3)"))
      << first.out;
  const std::string warning =
      "only a part was converted (--skip-first-n 1 --only-first-n 3); for the whole recording run "
      "dyslam on it again";
  EXPECT_FALSE(contains(first.err + first.out, warning));
  const Outcome later = run("dyslam", "-i " + at("run/recording.rawlog") + " -o " + at("later"));
  EXPECT_TRUE(contains(later.err, warning)) << later.err;

  const Outcome whole =
      run("dyslam", "-i " + at("drive.mcap") + " --topic /points -o " + at("run"));
  EXPECT_EQ(6, lines(folder_.read("run/trajectory_tum.txt"))) << whole.err;
  EXPECT_FALSE(contains(folder_.read("run/recording.ini"), "part ="));
}

TEST_F(DirectInput, ADamagedInputLeavesAnEarlierRecording)
{
  bins("scans");
  ASSERT_EQ(0, run("dyslam", "-q -i " + at("scans") + " -o " + at("run")).code);
  const std::string earlier = folder_.read("run/recording.rawlog");
  bins("damaged");
  fs::resize_file(at("damaged/000003.bin"), 1001);
  expectRefused("-q -i " + at("damaged") + " -o " + at("run"),
                {"000003.bin", "; the earlier " + at("run/recording.rawlog") + " stays"});
  EXPECT_EQ(earlier, folder_.read("run/recording.rawlog"));
  EXPECT_TRUE(contains(folder_.read("run/recording.ini"), "input = " + at("scans") + "\n"));

  expectRefused("-q -i " + at("damaged") + " -o " + at("new"),
                {"000003.bin", "; the scans before it are in " + at("new/recording.rawlog")});
  EXPECT_TRUE(contains(folder_.read("new/recording.ini"), "input = " + at("damaged") + "\n"));

  fs::remove(at("damaged/000000.bin"));  // no scan is left before the damaged one
  fs::remove(at("damaged/000001.bin"));
  fs::remove(at("damaged/000002.bin"));
  const Outcome nothing = run("dyslam", "-q -i " + at("damaged") + " -o " + at("run"));
  EXPECT_EQ(1, nothing.code);
  EXPECT_FALSE(contains(nothing.err, "the scans before it")) << nothing.err;
}

TEST_F(DirectInput, WhatCannotBeConverted)
{
  const std::string out = " -o " + at("never");
  folder_.write("pictures/1.png", "");
  expectRefused("-i " + at("pictures") + out,
                {"pictures: is no rawlog, bag, capture or folder of scans: it has no .bin"});
  bins("day/drive_sync/velodyne_points/data");
  expectRefused("-i " + at("day") + out, {"such as " + at("day/drive_sync")});
  expectRefused("-i " + folder_.write("x.pcap", "x") + out, {"x.pcap: is not a network capture"});
  expectRefused("-i " + at("day/drive_sync") + out + " --topic /points",
                {"--topic works with a bag or topics of ROS 2 only"});
  expectRefused("-i x.rawlog --dt 0.1" + out, {"--dt: is for an input that is converted"});
  fs::create_directories(at("tracking/velodyne/0001"));
  bins("tracking/velodyne/0000");
  expectRefused("-i " + at("tracking") + out,
                {"choose one with --sequence",
                 "kitti2rawlog --kind tracking -i " + at("tracking") + " --sequence ..."});
  bag("drive.mcap");
  expectRefused("-i " + at("drive.mcap") + out + " --deskewed no",
                {"--deskewed works with KITTI's folders only"});
  expectRefused("-i " + at("drive.mcap") + out + " --topic /nothing", {"/nothing is not in it"});
  expectRefused("-i " + at("drive.mcap") + out + " --set odometry.methd", {"odometry.methd"});
  expectRefused("-i " + at("drive.mcap") + out + " --set odometry.methd=gicp",
                {"[odometry]: unknown key 'methd'; did you mean 'method'?"});
  expectRefused("-i " + at("drive.mcap") + out + " --set map_export.epsg=25832",
                {"the section [map_export] belongs to dyslam-map"});
  for (const auto& [setting, reason] :
       {std::pair("map.voxel_size=abc", "[map] voxel_size = abc is not a number"),
        std::pair("map.voxel_size=-1", "is out of range"),
        std::pair("dyseg.method=nonsense", "unknown value 'nonsense'"),
        std::pair("prior_map.file=no.pcd", "prior_map.file: no.pcd: no such file or folder"),
        std::pair("input.pitch_deg=12", "add level = false")})
  {
    expectRefused("-i " + at("drive.mcap") + out + " --set " + setting, {reason});
  }
  expectRefused("--resume -i " + at("drive.mcap") + out, {"leave out --input"});
  expectRefused("--resume --topic /points" + out, {"--topic: is for an input that is converted"});
  EXPECT_FALSE(fs::exists(at("never")));

  bins("scans");
  expectRefused("-i " + at("scans") + " -o " + at("scans"), {"choose another --output"});
  EXPECT_FALSE(fs::exists(at("scans/recording.rawlog")));
}
}  // namespace dyslam
