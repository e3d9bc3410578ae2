// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
Trajectory someTrajectory()
{
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i)
  {
    trajectory.push_back(1317384506.123456 + 0.1 * i,
                         poseFromYpr(1000.123456789 + i, -2e-7 * i, 3, 0.3 * i, 0.1, -0.2));
  }
  return trajectory;
}

template <typename Call>
void expectError(Call&& call, const std::string& part)
{
  const std::string message = messageOfError<UserError>(call);
  EXPECT_TRUE(contains(message, part)) << message;
}
}  // namespace

TEST(TrajectoryFiles, TumRoundTrip)
{
  const TestFolder folder;
  const Trajectory trajectory = someTrajectory();
  writeTum(folder.file("a.txt"), trajectory);
  const Trajectory read = readTum(folder.file("a.txt"));
  ASSERT_EQ(trajectory.size(), read.size());
  for (std::size_t i = 0; i < read.size(); ++i)
  {
    EXPECT_EQ(trajectory[i].stamp, read[i].stamp);
    EXPECT_TRUE(trajectory[i].pose.isApprox(read[i].pose, 1e-11));
  }
  writeTum(folder.file("empty.txt"), {});
  EXPECT_TRUE(readTum(folder.file("empty.txt")).empty());
}

TEST(TrajectoryFiles, TumIsXyzwAndWellWritten)
{
  const TestFolder folder;
  Trajectory trajectory;
  trajectory.push_back(0.5, poseFromYpr(1, 2, 3, M_PI / 2, 0, 0));
  writeTum(folder.file("a.txt"), trajectory);
  EXPECT_EQ("0.500000000 1 2 3 0 0 0.707106781187 0.707106781187\n", folder.read("a.txt"));
}

TEST(MotionFiles, RoundTripAndErrorsWithTheirLine)
{
  const TestFolder folder;
  MotionCovariance motion{1317384506.123456, true};
  for (int i = 0; i < 6; ++i)
  {
    for (int j = 0; j < 6; ++j)
    {
      motion.covariance(i, j) = 1e-4 / (1 + i + j) + (i == j ? 1 : 0);
      motion.pose_noise(i, j) = -1e-9 * (i + j);
    }
  }
  const std::string text =
      motionFileHeader() + motionFileRow(MotionCovariance{}) + motionFileRow(motion);
  folder.write("motions.csv", text);
  const std::vector<MotionCovariance> read = readMotionFile(folder.file("motions.csv"));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].stamp, motion.stamp);
  EXPECT_FALSE(read[0].is_keyframe);
  EXPECT_TRUE(read[1].is_keyframe);
  EXPECT_TRUE(read[1].covariance.isApprox(motion.covariance, 1e-6));
  EXPECT_TRUE(read[1].pose_noise.isApprox(motion.pose_noise, 1e-6));
  EXPECT_TRUE(read[0].covariance.isZero(0));

  folder.write("short.csv", motionFileHeader() + "1.5,0,3\n");
  expectError([&] { (void)readMotionFile(folder.file("short.csv")); }, "short.csv:2: has 3 fields");
  folder.write("headless.csv", motionFileRow(motion));
  expectError([&] { (void)readMotionFile(folder.file("headless.csv")); }, "header");
}

TEST(TrajectoryFiles, KittiRoundTrip)
{
  const TestFolder folder;
  const Trajectory trajectory = someTrajectory();
  writeKittiPoses(folder.file("a.txt"), trajectory);
  const auto read = readKittiPoses(folder.file("a.txt"));
  ASSERT_EQ(trajectory.size(), read.size());
  for (std::size_t i = 0; i < read.size(); ++i)
  {
    EXPECT_TRUE(trajectory[i].pose.isApprox(read[i], 1e-11));
  }
}

TEST(TrajectoryFiles, TellsTheKinds)
{
  const TestFolder folder;
  writeTum(folder.file("tum.txt"), someTrajectory());
  writeKittiPoses(folder.file("kitti.txt"), someTrajectory());
  EXPECT_EQ(TrajectoryFormat::tum, readTrajectory(folder.file("tum.txt")).format);
  const auto kitti = readTrajectory(folder.file("kitti.txt"));
  EXPECT_EQ(TrajectoryFormat::kitti, kitti.format);
  EXPECT_EQ(19.0, kitti.trajectory[19].stamp);
  folder.write("comma.csv", "# t,x,y,z,qx,qy,qz,qw\n\n1.5,1,2,3,0,0,0,1\n");
  EXPECT_EQ(1.5, readTrajectory(folder.file("comma.csv")).trajectory[0].stamp);
}

TEST(TrajectoryFiles, AByteOrderMarkIsSkipped)
{
  const TestFolder folder;
  const std::string mark = "\xEF\xBB\xBF";
  const std::string row = "1.5 2 0 0 0 0 0 1\n";
  for (const std::string& text : {mark + row, mark + "# t x y z qx qy qz qw\n" + row})
  {
    const Trajectory read = readTrajectory(folder.write("a", text)).trajectory;
    ASSERT_EQ(1U, read.size());
    EXPECT_EQ(1.5, read[0].stamp);
    EXPECT_EQ(2, read[0].pose.translation().x());
  }
  const Trajectory euroc =
      readTrajectory(folder.write("a", mark + "#timestamp,x,y,z,qw,qx,qy,qz\n1e18,1,2,3,0,1,0,0\n"))
          .trajectory;
  EXPECT_NEAR(-1, euroc[0].pose.linear()(2, 2), 1e-12);  // half a turn about x
  expectError([&] { (void)readTum(folder.write("a", row + mark + row)); }, "a:2: ");
}

TEST(TrajectoryFiles, OfPosesOfOneTimeTheFirstCounts)
{
  const TestFolder folder;
  const Trajectory read = readTum(folder.write("a",
                                               "1 0 0 0 0 0 0 1\n"
                                               "2 5 0 0 0 0 0 1\n"
                                               "2 6 0 0 0 0 0 1\n"
                                               "3 7 0 0 0 0 0 1\n"));
  ASSERT_EQ(3U, read.size());
  EXPECT_EQ(5, read[1].pose.translation().x());
  EXPECT_EQ(3, read[2].stamp);
}

TEST(TrajectoryFiles, TimesMayBeInNanoseconds)
{
  const TestFolder folder;
  const Trajectory read = readTum(folder.write("a",
                                               "1403715524907143168.000000 0 0 0 0 0 0 1\n"
                                               "1403715525007143168.000000 1 0 0 0 0 0 1\n"));
  ASSERT_EQ(2U, read.size());
  EXPECT_NEAR(1403715524.907143, read[0].stamp, 1e-6);
  EXPECT_NEAR(0.1, read[1].stamp - read[0].stamp, 1e-6);
}

TEST(TrajectoryFiles, EurocsCsvHasNanosecondsAndWFirst)
{
  const TestFolder folder;
  const std::string header =
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
      "q_RS_y [], q_RS_z []";
  const std::string row = "1403715524907143168,1,2,3,0.5,0.5,-0.5,0.5";
  const std::string text = header + ", v_RS_R_x [m s^-1]\r\n" + row + ",7\r\n";
  for (const std::string& path :
       {folder.write("motion.csv", text), folder.write("poses.csv", header + "\n" + row + "\n"),
        folder.write("kimera.csv", "#timestamp,x,y,z,qw,qx,qy,qz,vx\n" + row + ",7\n"),
        folder.write("openvins.csv", "#time(ns),px,py,pz,qw,qx,qy,qz,vx\n" + row + ",7\n")})
  {
    const TrajectoryFile read = readTrajectory(path);
    EXPECT_EQ(TrajectoryFormat::tum, read.format);
    ASSERT_EQ(1U, read.trajectory.size()) << path;
    EXPECT_NEAR(1403715524.907143, read.trajectory[0].stamp, 1e-6);
    Pose expected = Pose::Identity();
    expected.linear() = Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5).toRotationMatrix();
    expected.translation() = Eigen::Vector3d(1, 2, 3);
    EXPECT_TRUE(read.trajectory[0].pose.isApprox(expected, 1e-12)) << path;
  }
  expectError([&] { (void)readTrajectory(folder.write("a.csv", header + "\n" + row + "\n1,2\n")); },
              "a.csv:3: has 2 fields, needs 8 or more");
  EXPECT_NEAR(2.5e-3,
              readTrajectory(folder.write("a.csv", header + "\n2500000,1,2,3,1,0,0,0\n"))
                  .trajectory[0]
                  .stamp,
              1e-12);
  // The same numbers below other names are x y z w.
  const Pose tum =
      readTrajectory(folder.write("tum.csv", "#timestamp,x,y,z,qx,qy,qz,qw\n" + row + "\n"))
          .trajectory[0]
          .pose;
  EXPECT_TRUE(tum.linear().isApprox(Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5).toRotationMatrix()));
}

TEST(TrajectoryFiles, MatricesMayHaveTimes)
{
  const TestFolder folder;
  const TrajectoryFile read =
      readTrajectory(folder.write("global_pose.csv",
                                  "1561000444390857630,0,-1,0,5,1,0,0,6,0,0,1,7\n"
                                  "1561000444490857630,1,0,0,5,0,1,0,6,0,0,1,8\n"));
  EXPECT_EQ(TrajectoryFormat::tum, read.format);
  ASSERT_EQ(2U, read.trajectory.size());
  EXPECT_NEAR(1561000444.390858, read.trajectory[0].stamp, 1e-6);
  EXPECT_TRUE(read.trajectory[0].pose.isApprox(poseFromYpr(5, 6, 7, M_PI / 2, 0, 0), 1e-12));
  EXPECT_EQ(8, read.trajectory[1].pose.translation().z());
  expectError([&] { (void)readTrajectory(folder.write("a", "2 1 0 0 0 0 1 0 0 0 0 1 0\n")); },
              "a:1: has 13 fields, of which the first is no time since 1970");
}

TEST(TrajectoryFiles, ErrorsNameFileAndLine)
{
  const TestFolder folder;
  const std::string good = "1 0 0 0 0 0 0 1\n";
  expectError([&] { (void)readTum(folder.write("a", good + "2 0 0\n")); }, "a:2: has 3 fields");
  expectError([&] { (void)readTum(folder.write("a", good + "2 0 0 zero 0 0 0 1\n")); },
              "a:2: 'zero' is not a number");
  expectError([&] { (void)readTum(folder.write("a", good + "2 0 nan 0 0 0 0 1\n")); },
              "a:2: 'nan' is not a finite number");
  expectError([&] { (void)readTum(folder.write("a", good + "2 0 -1e999 0 0 0 0 1\n")); },
              "a:2: '-1e999' is too large a number");
  expectError([&] { (void)readTum(folder.write("a", good + "2 0 1e200 0 0 0 0 1\n")); },
              "a:2: the position is more than 1e12 m from the origin; coordinates are in metres");
  expectError([&] { (void)readKittiPoses(folder.write("a", "1 0 0 0 0 1 0 -2e12 0 0 1 0\n")); },
              "a:1: the position is more than 1e12 m");
  expectError(
      [&] { (void)readTracks(folder.write("a", "0 1 Car 0 0 -10 0 0 0 0 1 2 3 4 5 1e13 0\n")); },
      "a:1: the position is more than 1e12 m");
  expectError(
      [&]
      { (void)readTracks(folder.write("a", "2147483647 1 Car 0 0 -10 0 0 0 0 1 2 3 4 5 6 0\n")); },
      "a:1: the frame is above 10000000");
  EXPECT_EQ(0, readTum(folder.write("a", "1 0 1e-999 0 0 0 0 1\n"))[0].pose.translation().y());
  expectError([&] { (void)readTum(folder.write("a", good + "2 0 0 0 0 0 0 2\n")); },
              "a:2: the quaternion's length");
  expectError([&] { (void)readTum(folder.write("a", "2 0 0 0 0 0 0 1\n" + good)); },
              "a:2: the time is before that of the line before; sort the lines by time");
  expectError([&] { (void)readKittiPoses(folder.write("a", "1 0 0 0 0 5 0 0 0 0 1 0\n")); },
              "a:1: columns");
  expectError([&] { (void)readKittiPoses(folder.write("a", "-1 0 0 0 0 1 0 0 0 0 1 0\n")); },
              "a:1: columns");
  expectError([&] { (void)readTrajectory(folder.write("a", "1 2 3\n")); }, "a:1: has 3 fields");
  expectError([&] { (void)readTrajectory(folder.write("a", "\n# nothing\n")); }, "no poses");
  expectError([&] { (void)readTrajectory(folder.file("none")); }, "no such file");
  expectError([&] { (void)readTrajectory(folder.path()); }, "is a folder");
  expectError([&] { writeTum(folder.file("no/such/a.txt"), {}); }, "cannot be written");
}

TEST(TrajectoryFiles, TimesWithTooFewDigitsAreAnError)
{
  const TestFolder folder;
  const auto lines = [](const std::string& time, int count)
  {
    std::string text;
    for (int i = 0; i < count; ++i)
    {
      text += time + ' ' + std::to_string(i) + " 0 0 0 0 0 1\n";
    }
    return text;
  };
  const Trajectory twice =
      readTum(folder.write("a", lines("1", 2) + lines("2", 5) + lines("3", 5)));
  ASSERT_EQ(3U, twice.size());
  EXPECT_EQ(0, twice[1].pose.translation().x()) << "the first of them";
  expectError([&] { (void)readTrajectory(folder.write("a", lines("1.7e+09", 20))); },
              "a:6: is the 6th line with the same time; write the times with more digits");
}

TEST(TrajectoryFiles, RealPosesOfCameraAndLidar)
{
  DYSLAM_REQUIRE_DATA();
  const std::string folder = *realDataFolder() + "/kitti_odometry_text/";
  for (const char* sequence : {"00", "04", "10"})
  {
    const auto camera = readKittiPoses(folder + "poses_gt_cam0/" + sequence + ".txt");
    EXPECT_GT(camera.size(), 200U);
    EXPECT_EQ(camera.size(), readTimes(folder + "calib_times/" + sequence + "/times.txt").size());
  }
}

TEST(TextFile, TablesHaveEmptyFieldsAndCommasInQuotes)
{
  const TestFolder folder;
  const std::string path = folder.write("t.csv",
                                        "a,b,c\r\n"
                                        ",2,\r\n"
                                        "\n"
                                        "# of another program\n"
                                        "\"x, y\",,\"\"\n"
                                        "1,2");
  TextFile file = TextFile::table(path);
  using Fields = std::vector<std::string_view>;
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.fields(), (Fields{"a", "b", "c"}));
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.fields(), (Fields{"", "2", ""}));
  EXPECT_EQ(file.integer(1), 2);
  expectError([&] { (void)file.number(0); }, "t.csv:2: '' is not a number");
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.fields(), (Fields{"x, y", "", ""}));
  ASSERT_TRUE(file.next());
  expectError([&] { file.requireFields(3, "as the header"); }, "t.csv:6: has 2 fields, needs 3");
  EXPECT_FALSE(file.next());
}

TEST(Labels, RoundTripAndBits)
{
  const TestFolder folder;
  const std::vector<Label> labels{0, 1, makeLabel(252, 7), makeLabel(40, 65535), 259};
  writeLabels(folder.file("a.label"), labels);
  EXPECT_EQ(labels, readLabels(folder.file("a.label")));
  EXPECT_EQ(labels, readLabels(folder.file("a.label"), 5));
  EXPECT_EQ(std::string("\xfc\x00\x07\x00", 4), folder.read("a.label").substr(8, 4));
  EXPECT_EQ(252, semanticOf(labels[2]));
  EXPECT_EQ(7, instanceOf(labels[2]));
  EXPECT_TRUE(isMovingLabel(labels[2]) && isMovingLabel(259) && isMovingLabel(label_moving));
  EXPECT_FALSE(isMovingLabel(250) || isMovingLabel(260) || isMovingLabel(40) || isMovingLabel(0));
  EXPECT_TRUE(isIgnoredLabel(0) && isIgnoredLabel(1) && isIgnoredLabel(makeLabel(0, 3)));
  EXPECT_FALSE(isIgnoredLabel(9));
  expectError([&] { (void)readLabels(folder.file("a.label"), 4); }, "has 5 labels");
  expectError([&] { (void)readLabels(folder.write("b.label", "abc")); }, "cut short");
  writeLabels(folder.file("c.label"), {});
  EXPECT_TRUE(readLabels(folder.file("c.label")).empty());
}

TEST(GroundTruth, SidecarRoundTrip)
{
  const TestFolder folder;
  EXPECT_EQ(folder.file("a.gt"), groundTruthFolder(folder.file("a.rawlog")));
  const std::vector<Label> labels{9, makeLabel(254, 3), 0};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> flow{{1, 2, 3}, {nan, nan, nan}, {0, -1, 0.5F}};
  LabelledBox box;
  box.frame = 2;
  box.id = 5;
  box.object_class = ObjectClass::pedestrian;
  box.box.centre = {1.25, -2.5, 0.125};
  box.box.size = {0.5, 0.75, 1.75};
  box.box.yaw = -1.5;
  box.occluded = 1;
  {
    GroundTruthWriter writer(folder.file("a.gt"));
    writer.addPose(1.0, Pose::Identity());
    writer.addPose(2.0, poseFromYpr(1, 2, 3, 0.5, 0, 0));
    writer.addLabels(2, labels);
    writer.addFlow(0, flow);
    writer.addBox(box);
    LabelledBox earlier = box;
    earlier.frame = 0;
    writer.addBox(earlier);
  }
  EXPECT_EQ(2U, readTum(folder.file("a.gt/poses_tum.txt")).size());
  EXPECT_EQ(labels, trueLabels(folder.file("a.gt"), 2, 3));
  EXPECT_FALSE(trueLabels(folder.file("a.gt"), 1, 3));
  EXPECT_FALSE(trueLabels(folder.file("none.gt"), 2, 3));
  expectError([&] { (void)trueLabels(folder.file("a.gt"), 2, 4); }, "000002.label");
  expectError([&] { (void)trueLabels(folder.file("a.gt"), 2, 2); }, "--further-lidars merges");
  const std::string flow_bytes = folder.read("a.gt/flow/000000.flow");
  ASSERT_EQ(36U, flow_bytes.size());
  EXPECT_EQ(0, std::memcmp(flow_bytes.data(), flow.data(), flow_bytes.size()));
  const auto tracks = readTracks(folder.file("a.gt/tracks.txt"));
  ASSERT_EQ(2U, tracks.size());
  EXPECT_EQ(0, tracks[0].frame);
  EXPECT_EQ(2, tracks[1].frame);
  const LabelledBox& read = tracks[1];
  EXPECT_EQ(5, read.id);
  EXPECT_EQ("Pedestrian", read.type);
  EXPECT_EQ(ObjectClass::pedestrian, read.object_class);
  EXPECT_EQ(box.box.centre, read.box.centre);
  EXPECT_EQ(box.box.size, read.box.size);
  EXPECT_EQ(box.box.yaw, read.box.yaw);
  EXPECT_EQ(1, read.occluded);
}

TEST(GroundTruth, WritingAgainLeavesNothingOld)
{
  const TestFolder folder;
  for (const std::size_t frames : {5U, 2U})
  {
    GroundTruthWriter writer(folder.file("a.gt"));
    for (std::size_t i = 0; i < frames; ++i)
    {
      writer.addLabels(i, {1, 2});
    }
    if (frames == 5)
    {
      writer.addPose(0, Pose::Identity());
    }
  }
  folder.write("a.gt/notes.md", "mine");
  EXPECT_TRUE(trueLabels(folder.file("a.gt"), 1, 2));
  EXPECT_FALSE(trueLabels(folder.file("a.gt"), 2, 2));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.gt/poses_tum.txt")));
  EXPECT_TRUE(std::filesystem::exists(folder.file("a.gt/notes.md")));
}

TEST(GroundTruth, IsInstalledBesideFilesOfOthers)
{
  const TestFolder folder;
  for (const bool notes : {false, true})
  {
    {
      GroundTruthWriter earlier(folder.file("a.gt"));
      earlier.addPose(0, Pose::Identity());
      earlier.addLabels(1, {1, 2});
    }
    {
      GroundTruthWriter writer(folder.file("a.gt.tmp"));
      writer.addLabels(0, {3, 4});
    }
    if (notes)
    {
      folder.write("a.gt/labels/notes.md", "mine");
    }
    removeGroundTruth(folder.file("a.gt"));
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.gt/poses_tum.txt")));
    EXPECT_FALSE(trueLabels(folder.file("a.gt"), 1, 2));
    installGroundTruth(folder.file("a.gt.tmp"), folder.file("a.gt"));
    EXPECT_EQ(trueLabels(folder.file("a.gt"), 0, 2), (std::vector<Label>{3, 4}));
    EXPECT_EQ(notes, std::filesystem::exists(folder.file("a.gt/labels/notes.md")));
    std::filesystem::remove_all(folder.file("a.gt.tmp"));
  }
}

/** Files and folders that others put where those of the sidecar belong. */
TEST(GroundTruth, WhatIsInTheWayIsNamed)
{
  const TestFolder folder;
  const auto install = [&folder]
  {
    {
      GroundTruthWriter writer(folder.file("a.gt.tmp"));
      writer.addPose(0, Pose::Identity());
      writer.addLabels(0, {3, 4});
    }
    installGroundTruth(folder.file("a.gt.tmp"), folder.file("a.gt"));
  };
  (void)folder.write("a.gt/labels", "mine");
  expectError(install, "a.gt/labels: cannot make this folder");
  std::filesystem::remove(folder.file("a.gt/labels"));
  (void)folder.write("a.gt/poses_tum.txt/notes.md", "mine");
  expectError(install, "a.gt/poses_tum.txt: cannot be written: Is a directory");
}

/** Of a simulator's options those that are read, and one more. */
struct WorldOfTest : Options
{
  std::string world = "campus", sensor = "VLP16";
  double traffic = 0.25;
  int seed = 900000003, columns = 7;
  void describe(OptionsVisitor& visitor) override
  {
    visitor.text("world", world, "");
    visitor.integer("columns", columns, 0, 9, "");
    visitor.text("sensor", sensor, "");
    visitor.real("traffic", traffic, 0, 1, "");
    visitor.integer("seed", seed, 0, 2147483647, "");
  }
};

TEST(GroundTruth, NamesTheSimulatedWorldUntilSomethingElseIsWritten)
{
  const TestFolder folder;
  const std::string truth = folder.file("a.gt");
  EXPECT_FALSE(simulatedWorld(truth));
  GroundTruthWriter(truth).addSimulator(WorldOfTest());
  const auto world = simulatedWorld(truth);
  ASSERT_TRUE(world);
  EXPECT_EQ(world->world, "campus");
  EXPECT_EQ(world->sensor, "VLP16");
  EXPECT_EQ(world->traffic, 0.25);
  EXPECT_EQ(world->seed, 900000003);
  GroundTruthWriter(truth).close();
  EXPECT_FALSE(simulatedWorld(truth));
  folder.write("a.gt/simulator.ini", "[simulator]\nworld = urban\nsensor = AVIA\ntraffic = 0\n");
  expectError([&] { (void)simulatedWorld(truth); }, "has no seed in [simulator]");
  folder.write("a.gt/simulator.ini",
               "[simulator]\nworld = urban\nsensor = AVIA\ntraffic = 0\nseed = x\n");
  expectError([&] { (void)simulatedWorld(truth); }, "seed");
}

TEST(GroundTruth, StatesWhereThePosesAreFrom)
{
  const TestFolder folder;
  const std::string truth = folder.file("a.gt");
  const auto write = [&](const PoseOrigin& origin, bool pose)
  {
    GroundTruthWriter writer(truth);
    writer.setPoseOrigin(origin);
    if (pose)
    {
      writer.addPose(0, Pose::Identity());
    }
    writer.close();
    return poseOrigin(truth);
  };
  EXPECT_EQ(PoseSource::unknown, poseOrigin(truth).source);
  for (const PoseSource source :
       {PoseSource::unknown, PoseSource::simulated, PoseSource::gnss_ins, PoseSource::given})
  {
    const PoseOrigin read = write({source, "a file.txt"}, true);
    EXPECT_EQ(source, read.source);
    EXPECT_EQ(source == PoseSource::unknown ? "" : "a file.txt", read.name);
    EXPECT_EQ(source == PoseSource::simulated, read.isExact());
    EXPECT_EQ(source, poseSourceFromString(toString(source)));
  }
  EXPECT_EQ("GNSS/INS (oxts), not exact", (PoseOrigin{PoseSource::gnss_ins, "oxts"}.text()));
  EXPECT_EQ("GNSS/INS", (PoseOrigin{PoseSource::gnss_ins, "oxts"}.differenceTo()));
  EXPECT_EQ("", (PoseOrigin{PoseSource::given, "poses.txt"}.differenceTo()));
  // A name cannot add lines of its own.
  EXPECT_EQ(PoseSource::given, write({PoseSource::given, "a\nsource = simulated"}, true).source);
  // That of an earlier recording does not stay, and without poses there is nothing to state.
  EXPECT_EQ(PoseSource::unknown, write({}, true).source);
  EXPECT_EQ(PoseSource::unknown, write({PoseSource::given, "x"}, false).source);
  // Simulated recordings have been marked by simulator.ini alone.
  GroundTruthWriter(truth).addSimulator(WorldOfTest());
  EXPECT_TRUE(poseOrigin(truth).isExact());
  EXPECT_EQ(PoseSource::unknown, poseSourceFromString("exact"));
  const TestFolder other;
  other.write("b.gt/poses.ini", "[poses]\nsource = guessed\n");
  expectError([&] { (void)poseOrigin(other.file("b.gt")); }, "guessed");
}

TEST(GroundTruth, BadFiles)
{
  const TestFolder folder;
  folder.write("a.gt/tracks.txt", "0 1 Car 0 0 -10 0 0 0 0 1 2 3 4 5 6\n");
  expectError([&] { (void)readTracks(folder.file("a.gt/tracks.txt")); },
              "tracks.txt:1: has 16 fields");
  folder.write("a.gt/tracks.txt", "x 1 Car 0 0 -10 0 0 0 0 1 2 3 4 5 6 0\n");
  expectError([&] { (void)readTracks(folder.file("a.gt/tracks.txt")); }, "tracks.txt:1: 'x'");
  folder.write("a.gt/tracks.txt", "0 1 Car 1e300 0 -10 0 0 0 0 1 2 3 4 5 6 0\n");
  expectError([&] { (void)readTracks(folder.file("a.gt/tracks.txt")); },
              "'1e300' is too large a number");
  folder.write("file.gt", "");
  EXPECT_THROW(GroundTruthWriter(folder.file("file.gt")), UserError);
}
}  // namespace dyslam
