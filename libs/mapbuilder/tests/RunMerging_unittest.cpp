// SPDX-License-Identifier: BSD-3-Clause
#include "RunMerging.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include "TestFolder.h"
#include "TestRun.h"

namespace dyslam
{
namespace
{
/** Nine scans, every fourth a keyframe. */
RunFolder runAlong(const Trajectory& trajectory)
{
  RunFolder run;
  run.folder = run.name = "run";
  run.trajectory = trajectory;
  run.graph = test::graphOf(trajectory, 4);
  for (std::size_t i = 0; i < trajectory.size(); i += 4)
  {
    run.keyframe_stamps.push_back(trajectory[i].stamp);
  }
  run.scans = test::asRecorded();
  return run;
}

TEST(MergedTrajectory, FollowsItsKeyframes)
{
  const RunFolder run = runAlong(test::straightDrive(9, 1));
  const Pose T = poseFromYpr(100, 20, 3, 1, 0, 0);
  std::vector<Pose> merged;
  for (std::size_t k = 0; k < 3; ++k)
  {
    merged.push_back(T * run.graph.pose(Key::ego(k)));
  }
  const Trajectory moved = mergedTrajectory(run, merged);
  ASSERT_EQ(9U, moved.size());
  for (std::size_t i = 0; i < 9; ++i)
  {
    EXPECT_EQ(run.trajectory[i].stamp, moved[i].stamp);
    EXPECT_TRUE(moved[i].pose.isApprox(T * run.trajectory[i].pose, 1e-9)) << i;
  }
}

TEST(MergedTrajectory, ChangesLinearlyBetweenKeyframes)
{
  const RunFolder run = runAlong(test::straightDrive(11, 1));
  std::vector<Pose> merged;
  for (std::size_t k = 0; k < 3; ++k)
  {
    merged.push_back(Eigen::Translation3d(0, static_cast<double>(k), 0) *
                     run.graph.pose(Key::ego(k)));
  }
  const Trajectory moved = mergedTrajectory(run, merged);
  for (std::size_t i = 0; i < 11; ++i)
  {
    const double expected =
        std::min(0.25 * static_cast<double>(i), 2.0);  // after the last: its own
    EXPECT_NEAR(expected, moved[i].pose.translation().y(), 1e-6) << i;
    EXPECT_NEAR(static_cast<double>(i), moved[i].pose.translation().x(), 1e-6) << i;
  }
}

TEST(MergedTrajectory, OfScansBeforeTheFirstKeyframeIsThatOfIt)
{
  RunFolder run = runAlong(test::straightDrive(9, 1));
  run.keyframe_stamps[0] += 1.5 * test::period;
  std::vector<Pose> merged;
  for (std::size_t k = 0; k < 3; ++k)
  {
    merged.push_back(Eigen::Translation3d(0, 5, 0) * run.graph.pose(Key::ego(k)));
  }
  EXPECT_NEAR(5, mergedTrajectory(run, merged)[0].pose.translation().y(), 1e-9);
}

TEST(MergeRuns, ReadsKeyframesAndGroundTruth)
{
  const TestFolder folder;
  const Trajectory drive = test::straightDrive(9, 1);
  RunFolder run = runAlong(drive);
  run.rawlog = folder.file("r.rawlog");
  test::writeRecording(run.rawlog, drive);
  test::RecordingListener listener;
  const MergedRuns joined = mergeRuns(test::listOf(std::move(run)), {}, {}, 1, listener);
  ASSERT_TRUE(joined.merge.joined(0));
  ASSERT_EQ(3U, joined.merge.poses[0].size());
  EXPECT_TRUE(joined.merge.poses[0][2].isApprox(drive[8].pose, 1e-6));
  ASSERT_EQ(1U, joined.truth.size());
  EXPECT_EQ(9U, joined.truth[0].size());
  EXPECT_EQ((std::vector<std::string>{"reading run", "finished 9"}), listener.log);
}

TEST(MergeRuns, KeyframesWithoutTheirScanAreKept)
{
  const TestFolder folder;
  const Trajectory drive = test::straightDrive(9, 1);
  RunFolder run = runAlong(drive);
  run.rawlog = folder.file("r.rawlog");
  Trajectory part;  // without the first and the last keyframe
  for (std::size_t i = 2; i < 7; ++i)
  {
    part.push_back(drive[i].stamp, drive[i].pose);
  }
  test::writeRecording(run.rawlog, part);
  MapListener listener;
  EXPECT_EQ(3U, mergeRuns(test::listOf(std::move(run)), {}, {}, 1, listener).merge.poses[0].size());
}

TEST(MergeRuns, NeighboursOfAKeyframesScanAreNoneWhateverTheTolerance)
{
  const TestFolder folder;
  const Trajectory drive = test::straightDrive(9, 1);
  Trajectory others;  // without the scans of the keyframes
  for (std::size_t i = 0; i < drive.size(); ++i)
  {
    if (i % 4 != 0)
    {
      others.push_back(drive[i].stamp, drive[i].pose);
    }
  }
  for (const double periods : {0.1, 1.5, 2.5})
  {
    RunFolder run = runAlong(drive);
    run.rawlog = folder.file("r.rawlog");
    run.scans.tolerance = periods * test::period;
    test::writeRecording(run.rawlog, others);
    MapListener listener;
    const std::string said = messageOfError<UserError>(
        [&] { (void)mergeRuns(test::listOf(std::move(run)), {}, {}, 1, listener); });
    EXPECT_TRUE(contains(said, "has none of the keyframes of run")) << periods << said;
  }
}

TEST(MergeRuns, TheRecordingOfAnotherRunIsNamed)
{
  const TestFolder folder;
  RunFolder run = runAlong(test::straightDrive(9, 1));
  run.rawlog = folder.file("other.rawlog");
  Trajectory later;
  for (const auto& [stamp, pose] : run.trajectory)
  {
    later.push_back(stamp + 3600, pose);
  }
  test::writeRecording(run.rawlog, later);
  MapListener listener;
  const std::string said = messageOfError<UserError>(
      [&] { (void)mergeRuns(test::listOf(std::move(run)), {}, {}, 1, listener); });
  EXPECT_TRUE(contains(said, "has none of the keyframes of run")) << said;
}
}  // namespace
}  // namespace dyslam
