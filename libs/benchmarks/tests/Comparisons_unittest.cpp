// SPDX-License-Identifier: BSD-3-Clause
// Comparisons of files: trajectories, tracks and maps.
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/DistanceCloud.h>
#include <dyslam/benchmarks/MapComparison.h>
#include <dyslam/benchmarks/TrackComparison.h>
#include <dyslam/benchmarks/TrackFiles.h>
#include <dyslam/benchmarks/TrajectoryComparison.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
using Names = std::vector<std::string>;

void ignore(const std::string& /*note*/) {}

std::vector<Pose> kittiSteps(int count)
{
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i)
  {
    poses.push_back(poseFromYpr(i, 0, 0, 0, 0, 0));
  }
  return poses;
}

LabelledBox boxOf(int frame, int id, const std::string& type, double x)
{
  LabelledBox box;
  box.frame = frame;
  box.id = id;
  box.type = type;
  box.object_class = objectClassFromString(type);
  box.box.centre = {x, 0, 0};
  box.box.size = {4, 2, 1.5};
  return box;
}

/** Four points in a plane, the last at `x`. */
Scan square(float x)
{
  Scan scan;
  scan.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {x, 1, 0}};
  return scan;
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
  EXPECT_TRUE(contains(messageOfError<UserError>(pairs), "only 0 of 10 time stamps"));
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
    return pairWarning(reference, estimate, pairs, report);
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
  EXPECT_EQ(pairWarning("rtk.txt", "vehicle.txt", found, report), "");
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
  { return pairWarning("r.txt", "e.txt", pairs, evaluateTrajectory("e", pairs)); };
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
  PathSummary path = readPath(folder.file("a.txt"), {});
  path.name = "a";
  EXPECT_FALSE(path.duration);
  EXPECT_DOUBLE_EQ(path.length, 4);
  EXPECT_DOUBLE_EQ(path.start_to_end, 4);
  EXPECT_EQ(pathTable({path}).toCsv(),
            "trajectory,poses,duration [s],length [m],start to end [m]\na,5,,4,4\n");
  EXPECT_TRUE(nlohmann::json::parse(pathJson({path}))["trajectories"][0]["duration_s"].is_null());
}

TEST(TrackComparison, ClassesAreThoseOfTheReferenceOrTheGivenOnes)
{
  const TestFolder folder;
  std::vector<LabelledBox> boxes;
  for (int frame = 0; frame < 10; ++frame)
  {
    boxes.push_back(boxOf(frame, 1, "Car", 10));
    boxes.push_back(boxOf(frame, 2, "Pedestrian", 20));
  }
  writeTracks(folder.file("a.txt"), boxes);
  writeTracks(folder.file("b.txt"), boxes);
  const TrackSources sources{folder.file("a.txt"), folder.file("b.txt"), ""};
  TrackSelection selection;
  const TrackData truth = readReferenceTracks(sources, selection, ignore);
  const TrackData estimate = readEstimatedTracks(sources, truth, selection);
  TrackSequence sequence = sequenceOf(sources, truth, estimate);
  EXPECT_EQ(sequence.frames, 10);
  EXPECT_FALSE(typesAreMerged(sources));
  EXPECT_FALSE(keepProcessedFrames(sources, sequence)) << "of a file";
  EXPECT_EQ(trackClasses(sources, sequence, {}), (Names{"Car", "Pedestrian", ""}));
  EXPECT_EQ(trackClasses(sources, sequence, {"Pedestrian", "Pedestrian"}), Names{"Pedestrian"});
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { (void)trackClasses(sources, sequence, {"Carr"}); }),
               "--class: unknown class 'Carr'; did you mean 'Car'?"));

  const TrackReport report = evaluateTracks(sources, {}, sequence, {"Car", ""}, {}, {});
  const auto json = nlohmann::json::parse(report.json);
  EXPECT_EQ(json["Car"]["references"], 10);
  EXPECT_DOUBLE_EQ(json["Car"]["mota"].get<double>(), 1);
  EXPECT_EQ(json["all"]["references"], 20);
  EXPECT_EQ(json["errors"]["all"]["all"]["found"], 20);
  EXPECT_EQ(report.metrics.rows(), 2U);

  const auto errorsOf = [&](const Names& given)
  {
    return nlohmann::json::parse(evaluateTracks(sources, {}, sequence, given, {}, {}).json)
        .at("errors");
  };
  const auto of_people = errorsOf({"Pedestrian"});
  EXPECT_EQ(of_people["Pedestrian"]["all"]["found"], 10);
  EXPECT_FALSE(of_people.contains("all")) << "of other classes, too";
  EXPECT_EQ(errorsOf({"Car", "Pedestrian"})["all"]["all"]["found"], 20);
}

TEST(TrackComparison, WhatTheSelectionOfTrueBoxesLacksIsNoted)
{
  const TestFolder folder;
  std::filesystem::create_directories(folder.file("x.gt"));
  writeTracks(folder.file("x.gt/tracks.txt"), {boxOf(0, 1, "Car", 10)});
  const TrackSources sources{folder.file("x.gt"), folder.file("x.gt/tracks.txt"), ""};
  Names notes;
  const auto read = [&](TrackSelection selection)
  {
    notes.clear();
    return readReferenceTracks(sources, selection,
                               [&](const std::string& note) { notes.push_back(note); });
  };
  EXPECT_NE(read({}).boxes.at(0).occluded, ignored_box);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_TRUE(contains(notes[0], "x.gt has no poses_tum.txt: speeds are not known"));
  EXPECT_TRUE(contains(notes[1], "x.gt has no labels: boxes count whatever"));
  TrackSelection every_box;
  every_box.min_speed = 0;
  every_box.min_points = 0;
  (void)read(every_box);
  EXPECT_TRUE(notes.empty());
}

TEST(TrackComparison, PredictionsOfHiddenObjectsAreNoFalseAlarms)
{
  TrackData truth;
  truth.boxes = {boxOf(1, 1, "Car", 10), boxOf(1, 2, "Car", 30)};
  truth.boxes[1].occluded = ignored_box;
  truth.hidden[1] = {{20, 0, 0}, {11, 0, 0}, {31, 0, 0}};
  std::vector<LabelledBox> estimates;
  for (const double x : {21.5, 22.5, 11.5, 31.0})
  {
    estimates.push_back(boxOf(1, static_cast<int>(x), "Car", x));
  }
  estimates.push_back(boxOf(2, 20, "Car", 20));
  removeUncovered(estimates, truth, {});
  std::vector<std::pair<int, int>> left;
  for (const LabelledBox& box : estimates)
  {
    left.emplace_back(box.frame, box.id);
  }
  EXPECT_EQ(left, (std::vector<std::pair<int, int>>{{1, 22}, {1, 11}, {2, 20}}))
      << "far from the hidden one; near a true box that counts; in a frame without hidden ones";
}

TEST(TrackComparison, IdsOfAFileAreThoseOfTracks)
{
  const TestFolder folder;
  const LabelledBox car = boxOf(3, 1, "Car", 10);
  writeTracks(folder.file("a.txt"), {car, boxOf(3, 2, "Car", 20)});
  writeTracks(folder.file("twice.txt"), {car, boxOf(3, 1, "Car", 20)});
  writeTracks(folder.file("none.txt"), {car, boxOf(3, -1, "Car", 20)});
  TrackSelection selection;
  const auto read = [&](const std::string& reference, const std::string& estimate)
  {
    const TrackSources sources{folder.file(reference), folder.file(estimate), ""};
    const TrackData truth = readReferenceTracks(sources, selection, ignore);
    (void)readEstimatedTracks(sources, truth, selection);
  };
  EXPECT_NO_THROW(read("none.txt", "a.txt")) << "a true box without an id is left out";
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { read("a.txt", "none.txt"); }),
                       "none.txt: a box of frame 3 has the id -1"));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { read("a.txt", "twice.txt"); }),
                       "twice.txt: two boxes of frame 3 have the id 1"));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { read("twice.txt", "a.txt"); }),
                       "twice.txt: two boxes of frame 3 have the id 1"));
}

TEST(TrackComparison, KittisImageRulesNeedRectangles)
{
  const TestFolder folder;
  const std::string calib =
      folder.write("calib.txt",
                   "P2: 700 0 600 0 0 700 180 0 0 0 1 0\nR_rect 1 0 0 0 1 0 0 0 1\n"
                   "Tr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\nTr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n");
  const std::string box = " 1.5 1.8 4 0 1.6 20 0\n";  // height, width, length, x, y, z, ry
  const std::string seen = folder.write("seen.txt", "0 1 Car 0 0 0 100 150 200 250" + box);
  const std::string blind = folder.write("blind.txt", "0 1 Car 0 0 0 0 0 0 0" + box);
  TrackSelection selection;
  const auto read = [&](const std::string& estimate)
  {
    const TrackSources sources{seen, estimate, calib};
    const TrackData truth = readReferenceTracks(sources, selection, ignore);
    return readEstimatedTracks(sources, truth, selection).boxes.size();
  };
  EXPECT_EQ(read(seen), 1U);
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)read(blind); }),
                       "blind.txt: its boxes have no rectangles in the image"));
}

TEST(TrackComparison, ScansThatWereDroppedShiftTheProcessedFrames)
{
  const TestFolder folder;
  std::vector<LabelledBox> boxes;
  for (int frame = 0; frame < 10; ++frame)
  {
    boxes.push_back(boxOf(frame, 1, "Car", 10));
  }
  writeTracks(folder.file("a.txt"), boxes);
  const std::string run = folder.file("run");
  folder.write("run/effective.ini", "[input]\nskip_first_n = 1\n");
  folder.write("run/report.json", R"({"frames": 4})");
  // Scans 1, 4 and 5 had the time stamp of the one before.
  const std::string table = folder.write(
      "run/scans.csv", "frame,stamp,reason\n2,0.2,\n3,0.3,\"no, none\"\n6,0.6,\n7,0.7,\n");
  writeTracks(run + "/tracks.txt", {boxOf(3, 1, "Car", 10)});
  const auto expectFrames = [&run](int first, int last)
  {
    const auto range = processedFrames(run);
    ASSERT_TRUE(range);
    EXPECT_EQ(range->first, first);
    EXPECT_EQ(range->last, last);
  };
  expectFrames(2, 7);
  const TrackSources sources{folder.file("a.txt"), run, ""};
  TrackSelection selection;
  const TrackData truth = readReferenceTracks(sources, selection, ignore);
  TrackSequence sequence =
      sequenceOf(sources, truth, readEstimatedTracks(sources, truth, selection));
  EXPECT_TRUE(keepProcessedFrames(sources, sequence));
  EXPECT_EQ(sequence.reference.size(), 6U) << "of scans 2 to 7";

  folder.write("run/scans.csv", "frame,stamp,reason\n");
  expectFrames(1, 4);
  ASSERT_TRUE(std::filesystem::remove(table));
  expectFrames(1, 4);
  folder.write("run/effective.ini", "[input]\nskip_first_n = 0\nstart = 0.1\n");
  EXPECT_FALSE(processedFrames(run));
}

TEST(MapComparison, LabelsAreInTheIntensityOrThereAreNone)
{
  const TestFolder folder;
  ReferenceMap reference{folder.file("a.ply"), square(1)};
  EXPECT_EQ(readReferenceLabels(reference).missing, "no intensity, no .label file");
  reference.cloud.intensity = {0, 0, 1, 1};
  EXPECT_EQ(readReferenceLabels(reference).labels,
            (std::vector<Label>{label_static, label_static, label_moving, label_moving}));
  reference.cloud.intensity = {40, 252, 1, 0};
  EXPECT_EQ(readReferenceLabels(reference).labels, (std::vector<Label>{40, 252, 1, 0}));
  reference.cloud.intensity = {0, 0.5F, 0, 0};
  EXPECT_TRUE(contains(readReferenceLabels(reference).missing, "intensity 0.5"));
}

TEST(MapComparison, IntensitiesThatWereMeasuredAreNoLabels)
{
  const TestFolder folder;
  ReferenceMap reference{folder.file("a.ply"), square(1)};
  for (const float value : {0.0F, 1.0F, 40.0F})  // 0: the recording has no intensities
  {
    reference.cloud.intensity.assign(reference.cloud.size(), value);
    const ReferenceLabels same = readReferenceLabels(reference);
    EXPECT_EQ(same.missing, "all intensities are " + std::to_string(std::lround(value)));
    EXPECT_TRUE(same.labels.empty());
  }
  reference.cloud.intensity = {0, 10, 117, 255};  // reflectivities
  const ReferenceLabels reflectivities = readReferenceLabels(reference);
  EXPECT_TRUE(contains(reflectivities.missing, "intensity 117")) << reflectivities.missing;
  EXPECT_TRUE(reflectivities.labels.empty());
  EXPECT_EQ(readReferenceLabels({reference.path, Scan()}).missing, "no intensity, no .label file");
}

TEST(MapComparison, LabelsSayWhetherTheyAreOfTheIntensity)
{
  const TestFolder folder;
  ReferenceMap reference{folder.file("a.ply"), square(1)};
  reference.cloud.intensity = {0, 0, 1, 1};
  EXPECT_EQ(readReferenceLabels(reference).from_intensity, "0: static, 1: moving");
  reference.cloud.intensity = {40, 252, 1, 0};
  EXPECT_EQ(readReferenceLabels(reference).from_intensity, "SemanticKITTI classes");
  writeLabels(folder.file("a.label"), {40, 40, 252, 0});
  const ReferenceLabels of_file = readReferenceLabels(reference);
  EXPECT_EQ(of_file.from_intensity, "");
  EXPECT_EQ(of_file.labels, (std::vector<Label>{40, 40, 252, 0}));
}

TEST(MapComparison, MapsAreComparedByLabelsOrByDistance)
{
  const TestFolder folder;
  writePly(folder.file("b.ply"), square(1.3F).points);
  const ReferenceMap reference{folder.file("a.ply"), square(1)};
  const std::vector<NamedMap> maps{{"b", folder.file("b.ply")}};
  const MapReport by_distance = compareByDistance(reference, maps, folder.file("d.ply"));
  const auto distance = nlohmann::json::parse(by_distance.json)["maps"][0];
  EXPECT_EQ(by_distance.table.rows(), 2U);
  EXPECT_NEAR(distance["estimate"]["max_m"].get<double>(), 0.3, 1e-6);
  EXPECT_NE(folder.read("d.ply").find("scalar_distance"), std::string::npos);

  const MapReport by_labels = compareByLabels(
      reference, {label_static, label_static, label_static, label_moving}, maps, {});
  const auto points = nlohmann::json::parse(by_labels.json)["maps"][0]["by_point"];
  EXPECT_EQ(points["static"], 3);
  EXPECT_EQ(points["dynamic"], 1);
  EXPECT_DOUBLE_EQ(
      std::sqrt(points["preservation"].get<double>() * points["rejection"].get<double>()),
      points["geometric_mean"].get<double>());
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] {
                             (void)compareByDistance({"empty.ply", Scan()}, maps);
                           }),
                       "empty.ply: has no points"));
}

TEST(DistanceCloud, HasColoursAndDistances)
{
  const std::vector<Eigen::Vector3f> points{{0, 1, 0}, {1, 1, 0}};
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_EQ((Colour{0, 64, 255}), colourOfDistance(0));
  EXPECT_EQ((Colour{230, 0, 0}), colourOfDistance(0.5F));
  EXPECT_EQ((Colour{230, 0, 0}), colourOfDistance(100));
  EXPECT_EQ((Colour{128, 128, 128}), colourOfDistance(std::numeric_limits<float>::quiet_NaN()));
  const std::string ply = distancePly(points, {0.F, 0.7F});
  EXPECT_NE(std::string::npos, ply.find("element vertex 2\n"));
  EXPECT_NE(std::string::npos, ply.find("property float scalar_distance\n"));
  const std::string end = "end_header\n";
  ASSERT_EQ(ply.find(end) + end.size() + 2 * 19, ply.size());
  float last = 0;
  std::memcpy(&last, ply.data() + ply.size() - sizeof last, sizeof last);
  EXPECT_EQ(0.7F, last);
  EXPECT_THROW((void)distancePly(points, {0.F}), std::invalid_argument);
}
}  // namespace dyslam
