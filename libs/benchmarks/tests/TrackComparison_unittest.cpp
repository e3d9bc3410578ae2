// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/TrackComparison.h>
#include <dyslam/benchmarks/TrackFiles.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "Names.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
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
}  // namespace

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

TEST(TrackComparison, BoxesInTheFrameOfACameraAreNoticed)
{
  const TrackSources sources{"label_02/0001.txt", "0001.txt", ""};
  TrackData ground;
  TrackData camera;
  for (int frame = 0; frame < 3; ++frame)
  {
    ground.boxes.push_back(boxOf(frame, 1, "Car", 10));
    ground.boxes.push_back(boxOf(frame, -1, "DontCare", 10));
    ground.boxes.back().box.centre.z() = 20;  // counts on no side
    camera.boxes.push_back(boxOf(frame, 1, "Car", 10));
    camera.boxes.back().box.centre = {3, 1.6, 20};
    ground.boxes.push_back(boxOf(frame, -1, "DontCare", 10));
    ground.boxes.back().box.centre.z() = 30;
  }
  EXPECT_EQ(boxFrameWarning(sources, ground, ground), "");
  EXPECT_EQ(boxFrameWarning(sources, TrackData(), TrackData()), "");
  EXPECT_TRUE(contains(boxFrameWarning(sources, camera, camera),
                       "label_02/0001.txt: most boxes are more than 5 m above the lidar"));
  EXPECT_EQ(boxFrameWarning(sources, ground, camera).find("0001.txt: most boxes"), 0U);
  EXPECT_EQ(boxFrameWarning({sources.reference, sources.estimate, "calib.txt"}, camera, camera),
            "");
}

TEST(TrackComparison, TrueSpeedsNeedPosesOfTheScans)
{
  const TestFolder folder;
  RawlogWriter writer(folder.file("x.rawlog"));
  Trajectory poses;
  Trajectory shifted;
  for (int i = 0; i < 2; ++i)
  {
    Scan scan;
    scan.stamp = 1000 + 0.1 * i;
    scan.points = {{5, 0, 0}};
    writer.write(scan);
    poses.push_back(scan.stamp, Pose::Identity());
    shifted.push_back(scan.stamp + 0.004, Pose::Identity());
  }
  writer.close();
  folder.write("x.gt/tracks.txt", "");
  // One object is at rest, the other one drives 1 m from scan to scan.
  writeTracks(folder.file("x.gt/tracks.txt"), {boxOf(0, 1, "Car", 10), boxOf(0, 2, "Car", 20),
                                               boxOf(1, 1, "Car", 10), boxOf(1, 2, "Car", 21)});
  std::vector<std::string> notes;
  TrackSelection selection;
  selection.min_points = 0;
  const auto ignored = [&]
  {
    notes.clear();
    TrackSelection given = selection;
    const TrackData truth = readTruth(folder.file("x.gt"), given,
                                      [&](const std::string& note) { notes.push_back(note); });
    return std::count_if(truth.boxes.begin(), truth.boxes.end(),
                         [](const LabelledBox& box) { return box.occluded == ignored_box; });
  };
  writeTum(folder.file("x.gt/poses_tum.txt"), poses);
  EXPECT_EQ(ignored(), 2) << "that at rest";
  EXPECT_TRUE(notes.empty());
  writeTum(folder.file("x.gt/poses_tum.txt"), shifted);
  EXPECT_EQ(ignored(), 0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(contains(notes[0], "poses_tum.txt has no pose within 1 ms of a scan")) << notes[0];
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
}  // namespace dyslam
