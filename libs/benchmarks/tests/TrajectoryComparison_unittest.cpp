// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/TrajectoryComparison.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "Names.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
std::vector<Pose> kittiSteps(int count)
{
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i)
  {
    poses.push_back(poseFromYpr(i, 0, 0, 0, 0, 0));
  }
  return poses;
}
}  // namespace

TEST(TrajectoryComparison, FilesWithoutTimesArePairedByLine)
{
  const TestFolder folder;
  writeKittiPoses(folder.file("a.txt"), kittiSteps(5));
  writeKittiPoses(folder.file("b.txt"), kittiSteps(4));
  Names notes;
  PoseReading reading;
  const auto pairs = [&]
  {
    return pairFiles(folder.file("a.txt"), folder.file("b.txt"), reading,
                     [&](const std::string& note) { notes.push_back(note); });
  };
  EXPECT_EQ(pairs().size(), 4U);
  EXPECT_EQ(notes, Names{folder.file("b.txt") + " has 4 poses, " + folder.file("a.txt") +
                         " 5; without time stamps they are associated by index"});
  reading.tolerance = 0.02;
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "leave --tolerance out"));
  reading.tolerance.reset();
  reading.time_offset = 1;
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "leave --time-offset out"));
}

TEST(TrajectoryComparison, TimesAreShiftedAndTheirDifferenceIsLimited)
{
  const TestFolder folder;
  Trajectory reference;
  Trajectory estimate;
  for (int i = 0; i < 10; ++i)
  {
    reference.push_back(i, kittiSteps(10)[static_cast<std::size_t>(i)]);
    estimate.push_back(i + 0.505, kittiSteps(10)[static_cast<std::size_t>(i)]);
  }
  writeTum(folder.file("a.txt"), reference);
  writeTum(folder.file("b.txt"), estimate);
  PoseReading reading;
  const auto pairs = [&]
  { return pairFiles(folder.file("a.txt"), folder.file("b.txt"), reading, ignore); };
  const std::string said = messageOfError<UserError>(pairs);
  EXPECT_TRUE(contains(said, "only 0 of 10 time stamps")) << said;
  EXPECT_TRUE(contains(said, "; --interpolate is for a reference whose stamps are not")) << said;
  reading.time_offset = 100;
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "; --time-offset is added to the"));
  reading.time_offset = -0.5;
  EXPECT_EQ(pairs().size(), 10U);
  reading.tolerance = 0.001;
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "within --tolerance 0.001 s"));
  reading = {};
  reading.interpolate = 0.6;
  ASSERT_EQ(pairs().size(), 9U) << "the last one is after the reference";
  EXPECT_NEAR(pairs().reference.front().translation().x(), 0.505, 1e-6);
  reading.interpolate = 0.2;
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "within --interpolate 0.2 s"));
}

TEST(TrajectoryComparison, AReferenceOfKittiMayHaveTimesInAnotherFile)
{
  const TestFolder folder;
  writeKittiPoses(folder.file("a.txt"), kittiSteps(5));
  Trajectory estimate;  // begins with the third scan
  for (int i = 2; i < 5; ++i)
  {
    estimate.push_back(100 + i, kittiSteps(5)[static_cast<std::size_t>(i)]);
  }
  writeTum(folder.file("b.txt"), estimate);
  PoseReading reading;
  Names notes;
  const auto pairs = [&]
  {
    return pairFiles(folder.file("a.txt"), folder.file("b.txt"), reading,
                     [&](const std::string& note) { notes.push_back(note); });
  };
  EXPECT_EQ(pairs().size(), 3U) << "by line, so the first scans are left";
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(contains(notes[0], "(--reference-times gives those of the reference)")) << notes[0];
  reading.reference_times = folder.write("times.txt", "100\n101\n102\n103\n104\n");
  reading.tolerance = 0.01;
  const PosePairs timed = pairs();
  ASSERT_EQ(timed.size(), 3U);
  EXPECT_DOUBLE_EQ(timed.stamps.front(), 102);
  EXPECT_DOUBLE_EQ(timed.reference.front().translation().x(), 2);
  folder.write("times.txt", "100\n101\n");
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "times.txt: has 2 times for 5 poses of"));
  folder.write("times.txt", "100\n101\n103\n102\n104\n");
  EXPECT_TRUE(
      contains(messageOfError<UserError>(pairs), "times.txt:4: the time does not come after"));
  writeTum(folder.file("a.txt"), estimate);
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "leave --reference-times out"));
  writeKittiPoses(folder.file("a.txt"), kittiSteps(5));
  writeKittiPoses(folder.file("b.txt"), kittiSteps(5));
  folder.write("times.txt", "100\n101\n102\n103\n104\n");
  reading.tolerance.reset();
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "leave --reference-times out"))
      << "the estimate has no times";
}

/** A curve driven by the vehicle, and the poses of an IMU on it. */
TEST(TrajectoryComparison, AReferenceMayBeOfAnotherBodyOfTheVehicle)
{
  const TestFolder folder;
  const Pose T_vehicle_imu = poseFromYpr(1.2, 0.4, -0.8, 0.5 * M_PI, 0, 0.1);
  Trajectory vehicle;
  Trajectory imu;
  Pose pose = Pose::Identity();
  for (int i = 0; i < 50; ++i)
  {
    vehicle.push_back(i, pose);
    imu.push_back(i, pose * T_vehicle_imu);
    pose = pose * poseFromYpr(1, 0, 0, 0.05, 0, 0);
  }
  writeTum(folder.file("vehicle.txt"), vehicle);
  writeTum(folder.file("imu.txt"), imu);
  PoseReading reading;
  const auto warning = [&](double* error)
  {
    const std::string reference = folder.file("imu.txt");
    const std::string estimate = folder.file("vehicle.txt");
    const PosePairs pairs = pairFiles(reference, estimate, reading, ignore);
    const TrajectoryReport report = evaluateTrajectory("vehicle", pairs);
    *error = report.relative.translation.rmse;
    return pairWarning(reference, estimate, reading, pairs, report);
  };
  double error = 0;
  EXPECT_TRUE(contains(warning(&error), "move in different directions of their bodies"));
  EXPECT_GT(error, 0.5);
  reading.reference_body = "1.2 0.4 -0.8 90 0 5.729577951308232";
  EXPECT_EQ(warning(&error), "");
  EXPECT_LT(error, 1e-6);
  reading.reference_body = "1.2 0.4";
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)warning(&error); }),
                       "--reference-body '1.2 0.4': six numbers are needed"));
}

/** A drive whose vehicle pitches and rolls, and the positions of an antenna on it. */
class TrajectoryAndPositions : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    Pose pose = Pose::Identity();
    for (int i = 0; i < 60; ++i)
    {
      vehicle.push_back(100 + i, pose);
      const Eigen::Vector3d p = frame * (pose * antenna);
      lines += std::to_string(100 + i) + ' ' + std::to_string(p.x()) + ' ' + std::to_string(p.y()) +
               ' ' + std::to_string(p.z()) + '\n';
      pose = pose * poseFromYpr(1, 0, 0, 0.05, 0.02 * std::sin(0.3 * i), 0.03 * std::sin(0.2 * i));
    }
    writeTum(folder.file("vehicle.txt"), vehicle);
  }
  [[nodiscard]] PosePairs pairs(const std::string& reference) const
  {
    return pairFiles(folder.file(reference), folder.file("vehicle.txt"), reading, ignore);
  }
  [[nodiscard]] std::string errorOf(const std::string& reference) const
  {
    return messageOfError<UserError>([&] { (void)pairs(reference); });
  }

  const TestFolder folder;
  const Eigen::Vector3d antenna{-0.5, 0.3, 1.6};
  const Pose frame = poseFromYpr(456000, 5427000, 110, 2.1, 0, 0);  // of the positions
  Trajectory vehicle;
  std::string lines;
  PoseReading reading;
};

TEST_F(TrajectoryAndPositions, ThePositionErrorNeedsNoOrientations)
{
  folder.write("rtk.txt", lines);
  const PosePairs without = pairs("rtk.txt");
  EXPECT_TRUE(without.positions_only);
  EXPECT_EQ(without.size(), 60U);
  EXPECT_GT(evaluateTrajectory("a", without).absolute.translation.rmse, 0.05) << "the lever arm";
  reading.reference_body = "-0.5 0.3 1.6 0 0 0";
  const PosePairs found = pairs("rtk.txt");
  const TrajectoryReport report = evaluateTrajectory("a", found);
  EXPECT_LT(report.absolute.translation.rmse, 1e-5);
  EXPECT_EQ(report.absolute.rotation_deg.count, 0U);
  EXPECT_EQ(report.relative.translation.count, 0U);
  EXPECT_EQ(report.drift.overall.segments, 0U);
  EXPECT_FALSE(report.forward_ratio);
  EXPECT_NEAR(report.length, 59, 3);
  EXPECT_EQ(pairWarning("rtk.txt", "vehicle.txt", reading, found, report), "");
}

TEST_F(TrajectoryAndPositions, ReferencesMayHaveOtherTimes)
{
  std::string every_third;
  std::istringstream all(lines);
  int number = 0;
  for (std::string line; std::getline(all, line); ++number)
  {
    every_third += number % 3 == 0 ? line + '\n' : "";
  }
  folder.write("rtk.txt", every_third);
  reading.reference_body = "-0.5 0.3 1.6 0 0 0";
  EXPECT_EQ(pairs("rtk.txt").size(), 20U);
  reading.interpolate = 3;
  const PosePairs interpolated = pairs("rtk.txt");
  EXPECT_EQ(interpolated.size(), 58U) << "up to the last of them";
  EXPECT_LT(evaluateTrajectory("a", interpolated).absolute.translation.rmse, 0.1);
}

TEST_F(TrajectoryAndPositions, LatitudeAndLongitudeBecomeMetres)
{
  const GeodeticPosition origin{49, 8.5, 110};
  std::string table = "latitude,longitude,altitude,time\n0,0,0,99\n";  // no fix at first
  for (const StampedPose& pose : vehicle)
  {
    const GeodeticPosition p = fromEnu(pose.pose.translation(), origin);
    table += std::to_string(p.latitude) + "0," + std::to_string(p.longitude) + "," +
             std::to_string(p.height) + "," + std::to_string(pose.stamp) + "\n";
  }
  folder.write("fix.csv", table);
  const TrajectoryReport report = evaluateTrajectory("a", pairs("fix.csv"));
  EXPECT_EQ(report.pairs, 60U);
  EXPECT_LT(report.absolute.translation.rmse, 0.15) << "six decimals of a degree";
  EXPECT_NEAR(report.length, 59, 3);
  folder.write("fix.csv", "time,lat,lon,height\n1,0,0,0\n2,91,500,0\n");
  EXPECT_TRUE(contains(errorOf("fix.csv"), "fix.csv: none of its latitudes and longitudes"));
}

TEST_F(TrajectoryAndPositions, GeocentricPositionsOfRtklibBecomeMetres)
{
  constexpr double of_2024 = 1716000000;                          // added to the stamps [s]
  Eigen::Isometry3d T_earth_enu = Eigen::Isometry3d::Identity();  // at 30 deg north, 0 deg east
  T_earth_enu.translation() << 5528256.639, 0, 3170373.735;
  T_earth_enu.linear() << 0, -0.5, std::sqrt(0.75),  //
      1, 0, 0,                                       //
      0, std::sqrt(0.75), 0.5;
  std::string table = "%  GPST  x-ecef(m)  y-ecef(m)  z-ecef(m)  Q  ns\n";
  for (const StampedPose& pose : vehicle)
  {
    const Eigen::Vector3d p = T_earth_enu * pose.pose.translation();
    table += "2314 " + std::to_string(528018 + pose.stamp) + ' ' + std::to_string(p.x()) + ' ' +
             std::to_string(p.y()) + ' ' + std::to_string(p.z()) + " 1 9\n";
  }
  folder.write("rtk.pos", table);
  reading.time_offset = of_2024;
  Names notes;
  const PosePairs found = pairFiles(folder.file("rtk.pos"), folder.file("vehicle.txt"), reading,
                                    [&](const std::string& note) { notes.push_back(note); });
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(contains(notes[0], "rtk.pos: its times are GPS time, 18 s ahead of UTC, and are"));
  const TrajectoryReport report = evaluateTrajectory("a", found);
  EXPECT_EQ(report.pairs, 60U);
  EXPECT_LT(report.absolute.translation.rmse, 1e-4);
  // East, north and up from the first position.
  EXPECT_LT((found.reference.back().translation() - vehicle[59].pose.translation()).norm(), 1e-3);
  folder.write("rtk.pos", "% GPST x-ecef(m) y-ecef(m) z-ecef(m)\n2314 1 0 0 0\n2314 2 0 0 0\n");
  EXPECT_TRUE(contains(errorOf("rtk.pos"), "rtk.pos: none of its positions is a place on the"));
}

TEST_F(TrajectoryAndPositions, WhatNeedsOrientationsIsRefused)
{
  folder.write("rtk.txt", lines);
  TrajectoryMetricsOptions first;
  first.alignment = Alignment::first;
  const PosePairs found = pairs("rtk.txt");
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { (void)evaluateTrajectory("a", found, first); }),
               "a: the alignment 'first' needs orientations, which the reference does not have"));
  reading.reference_body = "0 0 1 90 0 0";
  EXPECT_TRUE(contains(errorOf("rtk.txt"), "has positions alone; the three angles must be 0"));
  reading = {};
  reading.camera = "reference";
  EXPECT_TRUE(contains(errorOf("rtk.txt"), "leave --camera reference out"));
  reading = {};
  reading.reference_times = "times.txt";
  EXPECT_TRUE(contains(errorOf("rtk.txt"), "leave --reference-times out"));
  reading = {};
  writeKittiPoses(folder.file("vehicle.txt"), vehicle);
  EXPECT_TRUE(contains(errorOf("rtk.txt"), "vehicle.txt: has no time stamps (KITTI)"));
}

TEST(TrajectoryComparison, OtherUnitsAndQuaternionsAreWarnedOf)
{
  PosePairs pairs;
  Pose pose = Pose::Identity();
  for (int i = 0; i < 50; ++i)
  {
    pairs.stamps.push_back(i);
    pairs.reference.push_back(pose);
    pose = pose * poseFromYpr(1, 0, 0, 0.05, 0, 0);
  }
  const auto warning = [&]
  { return pairWarning("r.txt", "e.txt", {}, pairs, evaluateTrajectory("e", pairs)); };
  pairs.estimate = pairs.reference;
  EXPECT_EQ(warning(), "");
  for (Pose& estimate : pairs.estimate)
  {
    estimate.translation() *= 1000;
  }
  EXPECT_TRUE(contains(warning(), "are both in metres?")) << warning();
  for (std::size_t i = 0; i < pairs.size(); ++i)  // positions that fit, on their heads
  {
    pairs.estimate[i] = pairs.reference[i] * poseFromYpr(0, 0, 0, 0, 0, M_PI);
  }
  EXPECT_TRUE(contains(warning(), "the orientations do not (180 deg): quaternions with w first"))
      << warning();
}

/** A curve of the lidar, and of a camera that is mounted 0.3 m ahead of it and 0.1 m below. */
class CameraPoses : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    Pose pose = Pose::Identity();
    for (int i = 0; i < 50; ++i)
    {
      lidar_.push_back(pose);
      pose = pose * poseFromYpr(1, 0, 0, 0.05, 0, 0);
    }
    const std::vector<Pose> camera = posesOfMountedSensor(lidar_, T_cam_velo().inverse());
    for (const char* name : {"poses", "sequences/07"})
    {
      std::filesystem::create_directories(folder_.file(name));
    }
    writeKittiPoses(folder_.file("lidar.txt"), lidar_);
    writeKittiPoses(folder_.file("poses/07.txt"), camera);
  }
  /** Tr: x right, y down, z ahead; the lidar is 0.1 m above the camera and 0.3 m behind it. */
  static Pose T_cam_velo()
  {
    Pose pose = cameraAxes();
    pose.translation() << 0, -0.1, -0.3;
    return pose;
  }
  void writeCalib(const std::string& name) const
  {
    folder_.write(name, "Tr: 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3\n");
  }
  /** Largest distance between the poses of a pair. */
  double difference(const std::string& reference, const std::string& estimate)
  {
    notes_.clear();
    const PosePairs pairs = pairFiles(folder_.file(reference), folder_.file(estimate), reading_,
                                      [this](const std::string& note) { notes_.push_back(note); });
    warning_ = pairWarning("r.txt", "e.txt", reading_, pairs, evaluateTrajectory("e", pairs));
    double largest = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
    {
      largest = std::max(
          largest, (pairs.reference[i].translation() - pairs.estimate[i].translation()).norm());
    }
    return largest;
  }

  TestFolder folder_;
  std::vector<Pose> lidar_;
  PoseReading reading_;
  Names notes_;
  std::string warning_;
};

TEST_F(CameraPoses, AreConvertedOnEitherSide)
{
  writeCalib("sequences/07/calib.txt");
  for (const bool is_reference : {true, false})
  {
    const std::string reference = is_reference ? "poses/07.txt" : "lidar.txt";
    const std::string estimate = is_reference ? "lidar.txt" : "poses/07.txt";
    EXPECT_LT(difference(reference, estimate), 1e-5);
    EXPECT_EQ(warning_, "");
    ASSERT_EQ(notes_.size(), 1U);
    EXPECT_EQ(notes_[0], folder_.file("poses/07.txt") +
                             ": has the poses of a camera (z ahead), which are converted to the "
                             "lidar's with " +
                             folder_.file("sequences/07/calib.txt") +
                             " (--camera none: as they are)");
  }
  EXPECT_LT(difference("poses/07.txt", "poses/07.txt"), 1e-9);
  EXPECT_TRUE(notes_.empty()) << "both are of a camera";
}

TEST_F(CameraPoses, AreConvertedWithTheCalibrationThatThereIs)
{
  // By the axes alone the arm of 0.3 m from the lidar to the camera is an error in the curve: the
  // camera's motion is read as the lidar's, R (a) - a after a turn R.
  EXPECT_GT(difference("poses/07.txt", "lidar.txt"), 0.3);
  EXPECT_LT(difference("poses/07.txt", "lidar.txt"), 0.7) << "at most twice the arm";
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_TRUE(contains(notes_[0], "by the axes alone; --calib calib.txt gives its mounting"));
  writeCalib("other.txt");
  reading_.calib = folder_.file("other.txt");
  EXPECT_LT(difference("poses/07.txt", "lidar.txt"), 1e-5);
  EXPECT_LT(difference("lidar.txt", "lidar.txt"), 1e-9);
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_TRUE(contains(notes_[0], "other.txt: is not used, as ")) << notes_[0];
}

TEST_F(CameraPoses, AreLeftOrConvertedAsTheFlagSays)
{
  writeCalib("sequences/07/calib.txt");
  reading_.camera = "none";
  EXPECT_GT(difference("poses/07.txt", "lidar.txt"), 1);
  EXPECT_TRUE(notes_.empty());
  EXPECT_TRUE(contains(warning_, "the poses of r.txt have the axes of a camera (z ahead)"));
  lidar_.resize(12);  // a path where the camera's axes would fit as quaternions with w first
  for (Pose& pose : lidar_)
  {
    pose = poseFromYpr(pose.translation().x(), 0, 0, 0, 0, 0);
  }
  writeKittiPoses(folder_.file("short.txt"), lidar_);
  writeKittiPoses(folder_.file("camera.txt"), posesOfMountedSensor(lidar_, T_cam_velo().inverse()));
  for (const bool is_reference : {true, false})
  {
    (void)difference(is_reference ? "camera.txt" : "short.txt",
                     is_reference ? "short.txt" : "camera.txt");
    EXPECT_FALSE(contains(warning_, "quaternions")) << warning_;
  }
  reading_.camera = "reference";
  EXPECT_LT(difference("poses/07.txt", "lidar.txt"), 1e-5) << "with the calibration, as without it";
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_TRUE(contains(notes_[0], "07.txt: has the poses of a camera (z ahead), which are "))
      << notes_[0];
  EXPECT_TRUE(contains(notes_[0], folder_.file("sequences/07/calib.txt"))) << notes_[0];
  EXPECT_EQ(warning_, "");
  reading_.camera = "estimate";
  EXPECT_LT(difference("lidar.txt", "poses/07.txt"), 1e-5);
  EXPECT_EQ(notes_.size(), 1U);
  const PathSummary path = readPath(folder_.file("poses/07.txt"), reading_,
                                    [this](const std::string& note) { notes_.push_back(note); });
  EXPECT_NEAR(path.length, 49, 1e-3) << "the lidar's";
  ASSERT_EQ(notes_.size(), 2U);
  EXPECT_EQ(notes_[1], notes_[0]);
  reading_.camera = "reference";
  (void)difference("poses/07.txt", "poses/07.txt");
  EXPECT_EQ(warning_,
            "--camera reference has converted r.txt to the axes of a lidar, but e.txt has those of "
            "a camera (z ahead), too; without --camera the files decide");
  reading_.camera = "";
  reading_.reference_body = "0 0 1 0 0 0";
  EXPECT_GT(difference("poses/07.txt", "lidar.txt"), 1) << "the user states the bodies";
}

TEST(TrajectoryComparison, MeansAreOfOneMethod)
{
  const auto report = [](const std::string& name, double t_rel)
  {
    TrajectoryReport one;
    one.name = name;
    one.pairs = 10;
    one.length = 100;
    one.drift.overall.segments = 1;
    one.drift.overall.translation_percent = t_rel;
    one.drift.overall.rotation_deg_per_100m = 2 * t_rel;
    return one;
  };
  const std::vector<TrajectoryReport> reports{report("ours/00", 1), report("ours/01", 3),
                                              report("gicp/00", 4), report("gicp/01", 8)};
  const Names files{"out/ours/00.txt", "out/ours/01.txt", "out/gicp/00.txt", "out/gicp/01.txt"};
  Table both({"estimate", "poses", "length [m]", "t_rel [%]", "r_rel [deg/100m]"});
  EXPECT_EQ(addMeanRows(both, reports, files, {"00", "01", "00", "01"}), "");
  EXPECT_EQ(both.toCsv(),
            "estimate,poses,length [m],t_rel [%],r_rel [deg/100m]\n"
            "mean of ours,20,200,2,4\nmean of gicp,20,200,6,12\n");
  Table one({"estimate", "poses", "length [m]", "t_rel [%]", "r_rel [deg/100m]"});
  EXPECT_EQ(addMeanRows(one, reports, files, {"00", "01", "02", "03"}), "");
  EXPECT_TRUE(contains(one.toCsv(), "\nmean,40,400,4,8\n")) << one.toCsv();
  Table swapped({"estimate", "poses", "length [m]", "t_rel [%]", "r_rel [deg/100m]"});
  EXPECT_EQ(addMeanRows(swapped, reports, files, {"00", "01", "01", "00"}), "")
      << "the order is free";
  EXPECT_EQ(swapped.rows(), 2U);
  Table mixed({"estimate", "poses", "length [m]", "t_rel [%]", "r_rel [deg/100m]"});
  EXPECT_TRUE(
      contains(addMeanRows(mixed, reports, files, {"00", "00", "01", "01"}), "no mean, as "));
  EXPECT_EQ(mixed.rows(), 0U);
}

TEST(TrajectoryComparison, QuaternionsWithScalarFirstAreRecognised)
{
  PosePairs right;
  Pose pose = Pose::Identity();
  for (int i = 0; i < 50; ++i)
  {
    right.stamps.push_back(i);
    right.reference.push_back(pose);
    pose = pose * poseFromYpr(1, 0, 0, 0.05, 0.01, 0);
  }
  right.estimate = right.reference;
  const auto readWithScalarLast = [](std::vector<Pose> poses)
  {
    for (Pose& p : poses)
    {
      const Eigen::Quaterniond q(p.linear());  // the file has w x y z, taken for x y z w
      p.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
    }
    return poses;
  };
  const auto warning = [](const PosePairs& pairs)
  { return pairWarning("r.txt", "e.txt", {}, pairs, evaluateTrajectory("e", pairs)); };
  EXPECT_EQ(warning(right), "");
  PosePairs pairs = right;
  pairs.estimate = readWithScalarLast(right.estimate);
  EXPECT_TRUE(contains(warning(pairs), "the orientations of e.txt fit if its quaternions have w "))
      << warning(pairs);
  pairs = right;
  pairs.reference = readWithScalarLast(right.reference);
  EXPECT_TRUE(contains(warning(pairs), "the orientations of r.txt fit if its quaternions have w "))
      << warning(pairs);
  pairs.reference_has_quaternions = false;
  EXPECT_FALSE(contains(warning(pairs), "quaternions have w first")) << "KITTI has matrices";
}

TEST(TrajectoryComparison, ErrorsOfAPartOfThePathAreNoted)
{
  const TestFolder folder;
  const std::vector<Pose> steps = kittiSteps(100);
  Trajectory reference;
  for (int i = 0; i < 100; ++i)
  {
    reference.push_back(0.1 * i, steps[static_cast<std::size_t>(i)]);
  }
  writeTum(folder.file("a.txt"), reference);
  const auto notesOf = [&](int first, int end, int step, int gap_from, int gap_end)
  {
    Trajectory estimate;
    for (int i = first; i < end; i += step)
    {
      if (i < gap_from || i >= gap_end)
      {
        estimate.push_back(0.1 * i, steps[static_cast<std::size_t>(i)]);
      }
    }
    writeTum(folder.file("b.txt"), estimate);
    Names notes;
    (void)pairFiles(folder.file("a.txt"), folder.file("b.txt"), {},
                    [&](const std::string& note) { notes.push_back(note); });
    return notes;
  };
  EXPECT_TRUE(notesOf(0, 100, 1, 0, 0).empty());
  EXPECT_TRUE(notesOf(0, 100, 3, 0, 0).empty()) << "keyframes along the whole path";
  EXPECT_TRUE(notesOf(2, 98, 1, 50, 52).empty()) << "single scans";
  const Names early = notesOf(0, 31, 1, 0, 0);
  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0], folder.file("b.txt") + ": has poses along 30.0 of the 99.0 m of " +
                          folder.file("a.txt") + "; the errors are of this part");
  const Names gap = notesOf(0, 100, 1, 30, 70);
  ASSERT_EQ(gap.size(), 1U);
  EXPECT_TRUE(contains(gap[0], ": has poses along 58.0 of the 99.0 m of ")) << gap[0];
}

TEST(TrajectoryComparison, FiguresThatAreNotComparableAreNoted)
{
  TrajectoryReport every;
  every.name = "every";
  every.pairs = 100;
  TrajectoryReport keyframes = every;
  keyframes.name = "keyframes";
  keyframes.pairs = 20;
  EXPECT_TRUE(comparisonNotes({}, true).empty());
  EXPECT_TRUE(comparisonNotes({every, every}, true).empty());
  EXPECT_TRUE(comparisonNotes({every, keyframes}, false).empty()) << "several sequences";
  const Names notes = comparisonNotes({every, keyframes}, true);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(contains(notes[0], "keyframes has 20 poses, every 100: compare")) << notes[0];
  every.absolute.turned_by_orientations = true;
  const Names straight = comparisonNotes({every}, true);
  ASSERT_EQ(straight.size(), 1U);
  EXPECT_TRUE(contains(straight[0], "every: its path is nearly straight")) << straight[0];
}

TEST(TrajectoryComparison, ASinglePoseIsRefusedInEitherFile)
{
  const TestFolder folder;
  writeKittiPoses(folder.file("one.txt"), kittiSteps(1));
  writeKittiPoses(folder.file("many.txt"), kittiSteps(5));
  const std::string one = folder.file("one.txt") + ": has one pose; errors need two or more";
  for (const auto& [reference, estimate] :
       {std::make_pair("many.txt", "one.txt"), std::make_pair("one.txt", "many.txt")})
  {
    EXPECT_EQ(messageOfError<UserError>([&, r = folder.file(reference), e = folder.file(estimate)]
                                        { (void)pairFiles(r, e, {}, ignore); }),
              one);
  }
}

TEST(TrajectoryComparison, OfOnePathAreItsLengths)
{
  const TestFolder folder;
  writeKittiPoses(folder.file("a.txt"), kittiSteps(5));
  PathSummary path = readPath(folder.file("a.txt"), {}, [](const std::string&) {});
  path.name = "a";
  EXPECT_FALSE(path.duration);
  EXPECT_DOUBLE_EQ(path.length, 4);
  EXPECT_DOUBLE_EQ(path.start_to_end, 4);
  EXPECT_EQ(pathTable({path}).toCsv(),
            "trajectory,poses,duration [s],length [m],start to end [m]\na,5,,4,4\n");
  EXPECT_TRUE(nlohmann::json::parse(pathJson({path}))["trajectories"][0]["duration_s"].is_null());
}
}  // namespace dyslam
