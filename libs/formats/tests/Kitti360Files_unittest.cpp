// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/Kitti360Files.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The lidar's axes from those of the camera, which is 0.8 m ahead of it and 0.2 m below. */
constexpr const char* camera_to_lidar = "0 0 1 0.8 -1 0 0 0 0 -1 0 -0.2\n";
/** The IMU's axes (x ahead, y right, z down) from those of the camera, 1.5 m ahead, 0.6 m above. */
constexpr const char* cameras_to_imu =
    "image_00: 0 0 1 1.5 1 0 0 0 0 1 0 -0.6\nimage_01: 0 0 1 1.5 1 0 0 0.6 0 1 0 -0.6\n";
/** A rectification by a turn about the camera's axis of view, which nobody has. */
constexpr const char* perspective =
    "calib_time: 2013-05-28\ncorner_dist: 0.1\nS_00: 1392 512\nR_rect_00: 0 -1 0 1 0 0 0 0 1\n"
    "P_rect_00: 552 0 682 0 0 552 238 0 0 0 1 0\n";
}  // namespace

TEST(Kitti360Calib, PlacesTheLidarInTheFrameOfThePoses)
{
  const TestFolder folder;
  folder.write("c/calib_cam_to_velo.txt", camera_to_lidar);
  KittiCalib calib = readKitti360Calib(folder.file("c"));
  EXPECT_FALSE(calib.has_imu);
  EXPECT_FALSE(calib.has_camera);

  folder.write("c/calib_cam_to_pose.txt", cameras_to_imu);
  folder.write("c/perspective.txt", perspective);
  calib = readKittiCalib(folder.file("c"));
  ASSERT_TRUE(calib.has_imu);
  ASSERT_TRUE(calib.has_camera);
  // The lidar is 0.7 m ahead of the IMU and 0.8 m above it.
  const Pose T_imu_velo = calib.T_velo_imu.inverse();
  EXPECT_TRUE(
      (T_imu_velo * Eigen::Vector3d(0, 0, 0)).isApprox(Eigen::Vector3d(0.7, 0, -0.8), 1e-12))
      << T_imu_velo.translation().transpose();
  EXPECT_TRUE(
      (T_imu_velo * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(1.7, -2, -3.8), 1e-12));
  // 10 m ahead of the camera, 1 m to its right, before the rectification.
  EXPECT_TRUE((calib.T_cam_velo * Eigen::Vector3d(10.8, -1, -0.2))
                  .isApprox(Eigen::Vector3d(0, 1, 10), 1e-12));
  EXPECT_TRUE(readKittiCalib(folder.file("c/calib_cam_to_pose.txt")).has_camera);
}

TEST(Kitti360Calib, ErrorsNameTheFile)
{
  const TestFolder folder;
  EXPECT_FALSE(isKitti360Calib(folder.file("c")));
  const auto message = [&folder]
  { return messageOfError<UserError>([&] { (void)readKitti360Calib(folder.file("c")); }); };
  folder.write("c/calib_cam_to_velo.txt", "1 0 0\n");
  EXPECT_TRUE(contains(message(), "calib_cam_to_velo.txt: has 3 numbers, needs 12"));
  folder.write("c/calib_cam_to_velo.txt", "1 0 0 0\n0 1 0 0\n0 0 2 0\n");
  EXPECT_TRUE(contains(message(), "calib_cam_to_velo.txt: the matrix is not a rotation"));
  folder.write("c/calib_cam_to_velo.txt", camera_to_lidar);
  folder.write("c/calib_cam_to_pose.txt", "image_01: 0 0 1 1.5 1 0 0 0 0 1 0 -0.6\n");
  EXPECT_TRUE(contains(message(), "calib_cam_to_pose.txt: has no image_00"));
  folder.write("c/calib_cam_to_pose.txt", cameras_to_imu);
  folder.write("c/perspective.txt", "P_rect_00: 1\n");
  EXPECT_TRUE(contains(message(), "perspective.txt: has no R_rect_00"));
}

TEST(Kitti360Poses, ByTheNumberOfTheFrame)
{
  const TestFolder folder;
  const std::string imu =
      folder.write("poses.txt", "1 1 0 0 5 0 1 0 6 0 0 1 7\n14 1 0 0 8 0 1 0 9 0 0 1 7 \n");
  ASSERT_TRUE(hasKitti360Poses(imu));
  Kitti360Poses poses = readKitti360Poses(imu);
  EXPECT_FALSE(poses.are_of_camera);
  ASSERT_EQ(2U, poses.of_frame.size());
  EXPECT_EQ(Eigen::Vector3d(8, 9, 7), poses.of_frame.at(14).translation());

  const std::string camera =
      folder.write("cam0_to_world.txt", "3 0 -1 0 5 1 0 0 6 0 0 1 7 0 0 0 1\n");
  ASSERT_TRUE(hasKitti360Poses(camera));
  poses = readKitti360Poses(camera);
  EXPECT_TRUE(poses.are_of_camera);
  EXPECT_TRUE((poses.of_frame.at(3) * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(5, 7, 7)));
}

TEST(Kitti360Poses, OtherFilesAreNot)
{
  const TestFolder folder;
  const auto has = [&folder](const std::string& text)
  { return hasKitti360Poses(folder.write("p.txt", text)); };
  EXPECT_FALSE(has(""));
  EXPECT_FALSE(has("1 0 0 0 0 1 0 0 0 0 1 0\n")) << "KITTI";
  EXPECT_FALSE(has("0.1 0 0 0 0 0 0 1\n")) << "TUM";
  EXPECT_FALSE(has("1369742400.5 1 0 0 0 0 1 0 0 0 0 1 0\n")) << "by time";
  EXPECT_FALSE(has("frame 1 0 0 0 0 1 0 0 0 0 1 0\n"));
}

TEST(Kitti360Poses, ErrorsNameTheLine)
{
  const TestFolder folder;
  const std::string good = "1 1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto message = [&folder](const std::string& text)
  {
    return messageOfError<UserError>([&] { (void)readKitti360Poses(folder.write("p.txt", text)); });
  };
  EXPECT_TRUE(contains(message(good + good), "p.txt:2: frame 1 has a pose in an earlier line"));
  EXPECT_TRUE(contains(message(good + "2 1 0 0\n"), "p.txt:2: has 4 fields, needs 13"));
  EXPECT_TRUE(contains(message(good + "2.5 1 0 0 0 0 1 0 0 0 0 1 0\n"), "p.txt:2: '2.5'"));
  EXPECT_TRUE(contains(message("1 1 0 0 0 0 1 0 0 0 0 9 0\n"), "p.txt:1: the matrix is not a rot"));
  EXPECT_TRUE(contains(message("1 1 0 0 nan 0 1 0 0 0 0 1 0\n"), "p.txt:1: 'nan'"));
  EXPECT_TRUE(contains(message(""), "p.txt: holds no poses"));
  // Other readers of poses say which program reads them.
  EXPECT_TRUE(contains(
      messageOfError<UserError>([&] { (void)readTrajectory(folder.write("p.txt", good)); }),
      "kitti2rawlog --kind 360"));
}
}  // namespace dyslam
