// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/ScanReading.h>
#include <gtest/gtest.h>

#include "PoseReading.h"
#include "TestFolder.h"
#include "TestRecording.h"

namespace dyslam
{
namespace
{
class ScanReading : public testing::Test
{
 protected:
  void SetUp() override
  {
    recording.rawlog = folder.file("r.rawlog");
    test::writeRecording(recording.rawlog, drive);
  }
  /** Some of the poses, as KITTI's lines. */
  void writeKitti(std::size_t first, std::size_t count)
  {
    Trajectory part;
    for (std::size_t i = first; i < first + count; ++i)
    {
      part.push_back(0, drive[i].pose);
    }
    recording.trajectory = folder.file("kitti.txt");
    writeKittiPoses(recording.trajectory, part);
  }

  TestFolder folder;
  Trajectory drive = test::straightDrive(10, 1);
  RecordingOnTrajectory recording;
  test::RecordingListener listener;
};

TEST_F(ScanReading, EveryScanHasItsSweep)
{
  RawlogSource source(recording.rawlog);
  std::vector<double> sweeps;
  EXPECT_EQ("", readScans(source, "a reason", listener,
                          [&](const Frame& frame) { sweeps.push_back(frame.sweep_duration); }));
  ASSERT_EQ(10U, sweeps.size());
  EXPECT_NEAR(test::period, sweeps[0], 1e-6) << "that of the second";
  EXPECT_NEAR(test::period, sweeps[9], 1e-6);
  EXPECT_EQ((std::vector<std::string>{"reading a reason", "finished 10"}), listener.log);
  EXPECT_EQ(10U, listener.last_count);
  EXPECT_TRUE(listener.in_range);
}

TEST_F(ScanReading, DamageIsNamedAfterTheScansBefore)
{
  const std::string whole = folder.read("r.rawlog");
  RawlogSource source(folder.write("cut.rawlog", whole.substr(0, whole.size() / 2)));
  std::size_t scans = 0;
  const std::string damage = readScansAndWarn(source, "", listener, [&](const Frame&) { ++scans; });
  EXPECT_TRUE(contains(damage, "cut.rawlog")) << damage;
  EXPECT_GT(scans, 0U);
  EXPECT_LT(scans, 10U);
  EXPECT_EQ((std::vector<std::string>{"reading "}), listener.log) << "not finished";
}

TEST_F(ScanReading, TumPosesAreTakenAsTheyAre)
{
  recording.trajectory = folder.file("tum.txt");
  writeTum(recording.trajectory, drive);
  const Trajectory poses = readPoses(recording, listener);
  ASSERT_EQ(10U, poses.size());
  EXPECT_NEAR(drive[4].stamp, poses[4].stamp, 1e-6);
  EXPECT_TRUE(listener.log.empty());
}

TEST_F(ScanReading, PosesOfTheLidarBecomeThoseOfTheVehicle)
{
  recording.trajectory = folder.file("tum.txt");
  writeTum(recording.trajectory, drive);
  recording.of_lidar = true;
  const Trajectory poses = readPoses(recording, listener);
  EXPECT_TRUE(poses[4].pose.translation().isApprox(Eigen::Vector3d(4, 0, -1.7), 1e-6));
}

TEST_F(ScanReading, KittiPosesGetTheTimesOfTheScansThatAreUsed)
{
  recording.source.skip_first_n = 2;
  recording.source.only_first_n = 5;
  for (const bool all_of_file : {false, true})
  {
    writeKitti(all_of_file ? 0 : 2, all_of_file ? 10 : 5);
    const Trajectory poses = readPoses(recording, listener);
    ASSERT_EQ(5U, poses.size());
    for (std::size_t i = 0; i < 5; ++i)
    {
      EXPECT_NEAR(drive[i + 2].stamp, poses[i].stamp, 1e-6);
      EXPECT_TRUE(poses[i].pose.isApprox(drive[i + 2].pose, 1e-6));
    }
  }
  EXPECT_EQ("reading times", listener.log.front());
}

TEST_F(ScanReading, KittiPosesOfOtherScansAreRefused)
{
  recording.source.skip_first_n = 2;
  recording.source.only_first_n = 5;
  writeKitti(0, 7);
  const std::string said = messageOfError<UserError>([&] { (void)readPoses(recording, listener); });
  EXPECT_TRUE(contains(said, "has 7 poses, but 5 scans are used")) << said;
  EXPECT_TRUE(contains(said, "has 10;")) << said;
}
}  // namespace
}  // namespace dyslam
