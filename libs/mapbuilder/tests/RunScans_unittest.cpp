// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/mapbuilder/RunScans.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "TestFolder.h"
#include "TestRecording.h"

namespace dyslam
{
namespace
{
/** A box of 4 x 2 x 1.5 m on the ground, in the frame of the lidar of frameFrom(). */
LabelledBox boxAt(int frame, int id, double x)
{
  LabelledBox box;
  box.frame = frame;
  box.id = id;
  box.object_class = ObjectClass::car;
  box.type = "Car";
  box.box.centre = {x, 0, 0.75 - 1.7};
  box.box.size = {4, 2, 1.5};
  return box;
}

class RunScansTest : public testing::Test
{
 protected:
  [[nodiscard]] RunScans scans(const Trajectory& trajectory) { return {trajectory, options, pool}; }

  TestFolder folder;
  ThreadPool pool{1};
  RunScansOptions options = test::asRecorded();
};

TEST_F(RunScansTest, ScansHaveThePoseOfTheirTime)
{
  const RunScans run = scans(test::straightDrive(5, 1));
  Frame frame = test::frameFrom(Pose::Identity(), 3);
  const auto x = [&] { return run.poseOf(frame)->translation().x(); };
  EXPECT_EQ(3, x());
  frame.scan.stamp += 0.009;
  EXPECT_NEAR(3.09, x(), 1e-6) << "interpolated";
  frame.scan.stamp += 0.1;
  EXPECT_EQ(4, x()) << "after the last pose";
  frame.scan.stamp += 0.002;
  EXPECT_FALSE(run.poseOf(frame)) << "beyond the tolerance";
  EXPECT_THROW((void)scans(Trajectory()), UserError);
}

TEST_F(RunScansTest, InGapsOfTheTrajectoryTheyHaveNone)
{
  Trajectory sparse;
  for (const std::size_t i : {0, 10})
  {
    sparse.push_back(test::straightDrive(11, 1)[i].stamp, test::straightDrive(11, 1)[i].pose);
  }
  const RunScans run = scans(sparse);
  Frame frame = test::frameFrom(Pose::Identity(), 0);
  frame.scan.stamp += 0.009;
  EXPECT_EQ(0, run.poseOf(frame)->translation().x());
  EXPECT_FALSE(run.poseOf(test::frameFrom(Pose::Identity(), 3)));
}

/** An INS of 50 Hz whose stamps are not those of the scans. */
TEST_F(RunScansTest, OfAnInsAllScansHaveTheirPoseAndCloud)
{
  constexpr double step = 0.02;
  options.preprocess.deskew = DeskewMode::azimuth;
  Trajectory ins;
  for (int i = 0; i < 25; ++i)
  {
    const double time = -0.013 + step * i;
    ins.push_back(test::start_time + time, poseFromYpr(time / test::period, 0, 0, 0, 0, 0));
  }
  const Trajectory drive = test::straightDrive(5, 1);
  const RunScans of_scans = scans(drive);
  const RunScans of_ins = scans(ins);
  for (std::size_t i = 0; i < drive.size(); ++i)
  {
    Frame expected = test::frameFrom(drive[i].pose, i);
    expected.sweep_duration = test::period;
    Frame frame = expected;
    ASSERT_TRUE(of_ins.poseOf(frame));
    EXPECT_TRUE(of_ins.poseOf(frame)->isApprox(drive[i].pose, 1e-6)) << i;
    of_scans.fillCloud(expected);
    of_ins.fillCloud(frame);
    ASSERT_EQ(expected.cloud.size(), frame.cloud.size());
    for (std::size_t k = 0; k < frame.cloud.size(); ++k)
    {
      ASSERT_LT((expected.cloud.points[k] - frame.cloud.points[k]).norm(), 1e-4F) << i;
    }
  }
}

TEST_F(RunScansTest, CloudsAreInTheVehicleFrame)
{
  const RunScans run = scans(test::straightDrive(3, 1));
  Frame frame = test::frameFrom(poseFromYpr(1, 0, 0, 0, 0, 0), 1);
  run.fillCloud(frame);
  ASSERT_FALSE(frame.cloud.points.empty());
  const std::size_t source = frame.cloud.source.front();
  EXPECT_TRUE(frame.cloud.points.front().isApprox(
      frame.scan.points[source] + Eigen::Vector3f(0, 0, 1.7F), 1e-5F));
}

TEST_F(RunScansTest, ScansThatTheRunCouldNotRegister)
{
  const Trajectory drive = test::straightDrive(3, 1);
  EXPECT_TRUE(scans(drive).isRegistered(test::frameFrom(drive[1].pose, 1)));
  options.scan_table = folder.write("scans.csv", "frame,registered\n0,1\n1,0\n2,1\n");
  const RunScans run = scans(drive);
  EXPECT_TRUE(run.isRegistered(test::frameFrom(drive[0].pose, 0)));
  EXPECT_FALSE(run.isRegistered(test::frameFrom(drive[1].pose, 1)));
}

TEST_F(RunScansTest, WhatMovesIsByTheLabels)
{
  Frame frame = test::frameFrom(Pose::Identity(), 0, {{5, 1, 1}});
  std::vector<Label> labels(frame.scan.size(), label_static);
  labels.back() = label_moving;
  folder.write("run/labels/none.txt", "");
  options.labels = folder.file("run");
  EXPECT_THROW((void)scans(test::straightDrive(2, 1)), UserError) << "no .label file";
  writeLabels(folder.file("run/labels/000000.label"), labels);
  const RunScans run = scans(test::straightDrive(2, 1));
  EXPECT_TRUE(run.hasLabels());
  run.fillCloud(frame);
  run.fillMoving(frame);
  ASSERT_EQ(frame.cloud.size(), frame.moving.size());
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    EXPECT_EQ(frame.cloud.source[i] + 1 == frame.scan.size(), frame.moving[i]);
  }
  Frame later = test::frameFrom(Pose::Identity(), 1);
  run.fillCloud(later);
  const std::string said = messageOfError<UserError>([&] { run.fillMoving(later); });
  EXPECT_TRUE(contains(said, "000001.label")) << said;
  EXPECT_TRUE(contains(said, "dyslam --resume")) << said;
}

TEST_F(RunScansTest, LabelsBesideAFolderWithoutAnyAreFound)
{
  Frame frame = test::frameFrom(Pose::Identity(), 0);
  folder.write("run/labels/none.txt", "");
  writeLabels(folder.file("run/000000.label"), std::vector<Label>(frame.scan.size(), label_moving));
  options.labels = folder.file("run");
  const RunScans run = scans(test::straightDrive(2, 1));
  run.fillCloud(frame);
  const std::vector<Label> labels = run.labelsOf(frame);
  EXPECT_EQ(std::vector<Label>(frame.cloud.size(), label_moving), labels);
}

TEST_F(RunScansTest, ObjectsMoveInAllScansIfTheyMoveAtAll)
{
  options.tracks = folder.file("tracks.txt");
  // The vehicle drives on by 1 m a scan: object 1 stays, object 2 keeps its distance.
  writeTracks(options.tracks, {boxAt(0, 1, 10), boxAt(1, 1, 9), boxAt(2, 1, 8), boxAt(0, 2, 10),
                               boxAt(1, 2, 10), boxAt(2, 2, 10)});
  const Trajectory drive = test::straightDrive(3, 1);
  RunScans run = scans(drive);
  EXPECT_EQ(3U, run.trackedScans());
  EXPECT_TRUE(run.movingObjects().empty());
  for (std::size_t i = 0; i < 3; ++i)
  {
    run.noteObjects(test::frameFrom(drive[i].pose, i));
  }
  const auto moving = run.movingObjects();
  ASSERT_EQ(1U, moving.size());
  const ObjectPath& path = moving.at(2);
  ASSERT_EQ(3U, path.path.size());
  EXPECT_TRUE(path.path[2].isApprox(Eigen::Vector3d(12, 0, 0.75), 1e-6)) << path.path[2];
  EXPECT_TRUE(path.last.box.centre.isApprox(path.path[2], 1e-9));

  Frame frame = test::frameFrom(drive[0].pose, 0);
  frame.T_odom_vehicle = drive[0].pose;
  run.fillMoving(frame);
  ASSERT_EQ(2U, frame.objects.size());
  for (const TrackedObject& object : frame.objects)
  {
    EXPECT_EQ(object.id == 2, object.dynamic);
    EXPECT_TRUE(object.box.centre.isApprox(Eigen::Vector3d(10, 0, 0.75), 1e-6));
  }
}

constexpr const char* track_header = "frame,stamp,id,class,dynamic,score\n";

/** The boxes of a parked car whose box grows as more of it comes into view, and of one that drives
 * off at last. */
TEST_F(RunScansTest, TheTableOfARunSaysWhatMoves)
{
  const std::string boxes = folder.file("tracks.txt");
  writeTracks(boxes, {boxAt(0, 1, 10), boxAt(1, 1, 10.5), boxAt(2, 1, 11), boxAt(0, 2, 20),
                      boxAt(1, 2, 19), boxAt(2, 2, 18.5), boxAt(0, 3, 30), boxAt(2, 3, 31)});
  const Trajectory drive = test::straightDrive(3, 1);
  const auto moving = [&]
  {
    RunScans run = scans(drive);
    for (std::size_t i = 0; i < 3; ++i)
    {
      run.noteObjects(test::frameFrom(drive[i].pose, i));
    }
    std::vector<int> ids;
    for (const auto& [id, object] : run.movingObjects())
    {
      ids.push_back(id);
    }
    Frame first = test::frameFrom(drive[0].pose, 0);
    run.fillMoving(first);
    for (const TrackedObject& object : first.objects)
    {
      EXPECT_EQ(std::count(ids.begin(), ids.end(), object.id) == 1, object.dynamic) << object.id;
    }
    return ids;
  };
  options.tracks = boxes;
  EXPECT_EQ((std::vector<int>{1, 3}), moving()) << "by their displacement";
  folder.write("tracks.csv", std::string(track_header) +
                                 "0,0,1,Car,0,1\n1,0,1,Car,0,1\n0,0,2,Car,0,1\n1,0,2,Car,0,1\n"
                                 "2,,2,,1,\n");
  EXPECT_EQ((std::vector<int>{2, 3}), moving()) << "the table does not have 3";
  options.tracks = folder.file("tracks.csv");
  EXPECT_EQ((std::vector<int>{2, 3}), moving());
}

TEST_F(RunScansTest, TablesOfTracksThatAreNone)
{
  const Trajectory drive = test::straightDrive(3, 1);
  const auto said = [&] { return messageOfError<UserError>([&] { (void)scans(drive); }); };
  options.tracks = folder.write("tracks.csv", std::string(track_header) + "0,0,1,Car,0,1\n");
  EXPECT_TRUE(contains(said(), "tracks.csv: tracks.txt, which has the boxes")) << said();
  writeTracks(folder.file("tracks.txt"), {boxAt(0, 1, 10)});
  EXPECT_NO_THROW((void)scans(drive));
  folder.write("tracks.csv", std::string(track_header) + "0,0,one,Car,0,1\n");
  EXPECT_TRUE(contains(said(), "tracks.csv:2")) << said();
  folder.write("tracks.csv", "id,x\n1,2\n");
  EXPECT_TRUE(contains(said(), "has no columns 'id' and 'dynamic'")) << said();
  options.tracks = folder.file("tracks.txt");
  EXPECT_NO_THROW((void)scans(drive)) << "a table of another program beside it";
}

TEST_F(RunScansTest, ScansWithoutAPoseHaveNoObjects)
{
  options.tracks = folder.file("tracks.txt");
  writeTracks(options.tracks, {boxAt(0, 1, 10), boxAt(7, 1, 30)});
  RunScans run = scans(test::straightDrive(3, 1));
  EXPECT_EQ(8U, run.trackedScans());
  run.noteObjects(test::frameFrom(Pose::Identity(), 0));
  run.noteObjects(test::frameFrom(Pose::Identity(), 7));  // after the trajectory
  EXPECT_TRUE(run.movingObjects().empty());
}
}  // namespace
}  // namespace dyslam
