// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/train/RecordingFiles.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace dyslam
{
namespace
{
/** A vehicle that drives 19 m along a bend; its camera is beside the lidar and looks ahead. */
class PosesOfARecording : public ::testing::Test
{
 protected:
  PosesOfARecording()
  {
    std::filesystem::create_directories(folder_);
    T_cam_velo_ = cameraAxes();
    T_cam_velo_.translation() = Eigen::Vector3d(0.1, -0.05, -0.3);
    for (int k = 0; k < 20; ++k)
    {
      lidar_.push_back(poseFromYpr(k, 0.02 * k * k, 0, 0.04 * k, 0, 0));
    }
    writeKittiPoses(folder_ + "/lidar.txt", lidar_);
    writeKittiPoses(folder_ + "/camera.txt", posesOfMountedSensor(lidar_, T_cam_velo_.inverse()));
    std::string row;
    for (int i = 0; i < 12; ++i)
    {
      row += " " + std::to_string(T_cam_velo_.matrix()(i / 4, i % 4));
    }
    writeWhole(folder_ + "/calib.txt", "Tr:" + row + "\n");
  }
  ~PosesOfARecording() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] RecordingDescription described(const std::string& poses, bool calib) const
  {
    return parseRecording("velodyne;" + poses + ";0;19" + (calib ? "; calib=calib.txt" : ""),
                          folder_, "[train] labelled_runs");
  }

  [[nodiscard]] std::string saidOf(const std::string& poses, bool calib) const
  {
    try
    {
      (void)readLidarPoses(described(poses, calib));
    }
    catch (const UserError& e)
    {
      return e.what();
    }
    return "";
  }

  Pose T_cam_velo_ = Pose::Identity();
  std::vector<Pose> lidar_;
  std::string folder_ = ::testing::TempDir() + "dyslam_recording_poses";
};

TEST_F(PosesOfARecording, ThoseOfTheCameraBecomeThoseOfTheLidar)
{
  const auto given = readLidarPoses(described("lidar.txt", false));
  const auto converted = readLidarPoses(described("camera.txt", true));
  ASSERT_EQ(given.size(), lidar_.size());
  ASSERT_EQ(converted.size(), lidar_.size());
  for (std::size_t k = 0; k < lidar_.size(); ++k)
  {
    EXPECT_TRUE(given[k].isApprox(lidar_[k], 1e-6)) << k;
    EXPECT_TRUE(converted[k].isApprox(lidar_[k], 1e-4)) << k;
  }
}

TEST_F(PosesOfARecording, ThoseOfTheOtherSensorAreRefused)
{
  EXPECT_NE(saidOf("camera.txt", false).find("add ;calib=calib.txt"), std::string::npos)
      << saidOf("camera.txt", false);
  EXPECT_NE(saidOf("lidar.txt", true).find("leave out calib="), std::string::npos)
      << saidOf("lidar.txt", true);
}

TEST(MotionInto, IsThatOfTheStepBefore)
{
  const std::vector<Pose> poses{poseFromYpr(0, 0, 0, 0, 0, 0), poseFromYpr(1, 0, 0, 0, 0, 0),
                                poseFromYpr(3, 0, 0, 0, 0, 0)};
  EXPECT_NEAR(motionInto(poses, 0).translation().x(), 1, 1e-12) << "none is known: the next";
  EXPECT_NEAR(motionInto(poses, 1).translation().x(), 1, 1e-12);
  EXPECT_NEAR(motionInto(poses, 2).translation().x(), 2, 1e-12);
  EXPECT_TRUE(motionInto({poses[2]}, 0).isApprox(Pose::Identity()));
}
}  // namespace
}  // namespace dyslam
