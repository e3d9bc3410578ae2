// SPDX-License-Identifier: BSD-3-Clause
// Drives of KITTI-360.
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/RecordingConverter.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "KittiFolders.h"

namespace dyslam
{
namespace
{
constexpr const char* drive_name = "2013_05_28_drive_0003_sync";

std::string drivePath(const std::string& name = drive_name)
{
  return "KITTI-360/data_3d_raw/" + name;
}

/** A line of poses.txt: the IMU (x ahead, y right, z down) on a level road, heading east. */
std::string imuPose(int frame, double x)
{
  return std::to_string(frame) + " 1 0 0 " + std::to_string(x) + " 0 -1 0 50 0 0 -1 110 \n";
}

/** Four scans, with poses of frames 1, 2 and 9. The lidar is 0.7 m ahead of the IMU and 0.8 m above
 * it, with z up. */
void writeDrive(const TestFolder& folder)
{
  const std::string drive = drivePath() + "/velodyne_points";
  writeBins(folder, drive + "/data", 4, 10);
  folder.write(drive + "/timestamps.txt",
               "2013-05-28 08:46:02.904\n2013-05-28 08:46:03.008\n2013-05-28 08:46:03.112\n"
               "2013-05-28 08:46:03.216\n");
  folder.write("KITTI-360/calibration/calib_cam_to_velo.txt", "0 0 1 0.8 -1 0 0 0 0 -1 0 -0.2\n");
  folder.write("KITTI-360/calibration/calib_cam_to_pose.txt",
               "image_00: 0 0 1 1.5 1 0 0 0 0 1 0 -0.6\n");
  folder.write("KITTI-360/data_poses/" + std::string(drive_name) + "/poses.txt",
               imuPose(1, 100) + imuPose(2, 101) + imuPose(9, 105));
}

KittiConverterOptions optionsOf360()
{
  KittiConverterOptions options;
  options.kind = KittiKind::kitti360;
  return options;
}

ConversionResult convert(const TestFolder& folder,
                         const std::string& input,
                         const KittiConverterOptions& options = optionsOf360())
{
  return convertKitti(folder.file(input), folder.file("x.rawlog"), options);
}

std::string messageOf(const TestFolder& folder,
                      const std::string& input,
                      const KittiConverterOptions& options = optionsOf360())
{
  return messageOfError<UserError>([&] { (void)convert(folder, input, options); });
}
}  // namespace

TEST(Kitti360, TheDataSetHasEverythingADriveNeeds)
{
  const TestFolder folder;
  writeDrive(folder);
  KittiConverterOptions options = optionsOf360();
  for (const std::string sequence : {"", "0003", drive_name})
  {
    options.sequence = sequence;
    const auto result = convert(folder, "KITTI-360", options);
    EXPECT_EQ(4U, result.scans);
    EXPECT_EQ(2U, result.poses);
    ASSERT_EQ(1U, result.warnings.size());
    EXPECT_TRUE(contains(result.warnings[0], "has no pose for 2 of 4 scans: KITTI-360"))
        << result.warnings[0];
  }
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(1369730762.904, frames.at(0).scan.stamp, 1e-6);
  EXPECT_FALSE(frames[0].T_world_vehicle_truth);
  EXPECT_FALSE(frames.at(3).T_world_vehicle_truth);
  // Frame 1 is the scan 0000000001.bin. The lidar's y is to the left, so its world is upright.
  EXPECT_EQ(11U, frames.at(1).scan.size());
  const Pose& truth = frames[1].T_world_vehicle_truth.value();
  EXPECT_TRUE((truth * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(101.7, 52, 113.8), 1e-9))
      << (truth * Eigen::Vector3d(1, 2, 3)).transpose();
  // By time, the file has those that there are.
  const Trajectory poses = readTum(folder.file("x.gt/poses_tum.txt"));
  ASSERT_EQ(2U, poses.size());
  EXPECT_NEAR(frames[1].scan.stamp, poses[0].stamp, 1e-6);
  EXPECT_NEAR(frames[2].scan.stamp, poses[1].stamp, 1e-6);
  EXPECT_EQ(PoseSource::given, poseOrigin(folder.file("x.gt")).source);
}

TEST(Kitti360, TheFolderOfADriveIsEnough)
{
  const TestFolder folder;
  writeDrive(folder);
  EXPECT_EQ(2U, convert(folder, drivePath()).poses);
  EXPECT_EQ(2U, convert(folder, drivePath() + "/").poses);
  EXPECT_EQ(2U, convert(folder, "KITTI-360/data_3d_raw").poses);
  const RecordingConverter converter(folder.file(drivePath()));
  EXPECT_EQ("kitti2rawlog --kind 360", converter.program());
  EXPECT_EQ(2U, converter.convert(folder.file("x.rawlog"), {}).poses);
  {
    const WorkingFolder within(folder.file(drivePath()));
    EXPECT_EQ(2U, convertKitti(".", folder.file("x.rawlog"), optionsOf360()).poses);
  }
  // Without data_3d_raw between, and under another name with all files in it.
  std::filesystem::rename(folder.file(drivePath()),
                          folder.file("KITTI-360/" + std::string(drive_name)));
  EXPECT_EQ(2U, convert(folder, "KITTI-360/" + std::string(drive_name)).poses);
  std::filesystem::rename(folder.file("KITTI-360/" + std::string(drive_name)), folder.file("mine"));
  EXPECT_EQ(0U, convert(folder, "mine").poses);
  std::filesystem::rename(folder.file("KITTI-360/calibration"), folder.file("mine/calibration"));
  folder.write("mine/poses.txt", imuPose(3, 100));
  EXPECT_EQ(1U, convert(folder, "mine").poses);
}

TEST(Kitti360, PosesOfTheCameraAndOfOtherFiles)
{
  const TestFolder folder;
  writeDrive(folder);
  folder.write("KITTI-360/calibration/perspective.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n");
  KittiConverterOptions options = optionsOf360();
  // The camera of the pose of frame 2 above: 1.5 m ahead of the IMU, 0.6 m above it.
  options.poses =
      folder.write("cam0_to_world.txt", "2 0 0 1 102.5 -1 0 0 50 0 -1 0 110.6 0 0 0 1 \n");
  const auto truth = [&]
  {
    EXPECT_EQ(1U, convert(folder, "KITTI-360", options).poses);
    return readTum(folder.file("x.gt/poses_tum.txt"))[0].pose;
  };
  EXPECT_TRUE(
      (truth() * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(102.7, 52, 113.8), 1e-9));
  options.pose_frame = PoseFrame::lidar;
  EXPECT_TRUE(truth().translation().isApprox(Eigen::Vector3d(102.5, 50, 110.6), 1e-9));
  options.pose_frame = PoseFrame::automatic;
  std::filesystem::remove(folder.file("KITTI-360/calibration/perspective.txt"));
  EXPECT_TRUE(contains(messageOf(folder, "KITTI-360", options), "has no perspective.txt"));

  options.poses = folder.file("tum.txt");
  Trajectory of_lidar;
  of_lidar.push_back(1369730763.008, somePose(1));
  writeTum(options.poses, of_lidar);
  EXPECT_TRUE(truth().isApprox(somePose(1), 1e-6));
}

TEST(Kitti360, TimesMayBeOfTheScansThatThereAre)
{
  const TestFolder folder;
  writeDrive(folder);
  const std::string points = drivePath() + "/velodyne_points/";
  // As the SLAM test set leaves frames out, and drive 0002 its first ones.
  std::filesystem::rename(folder.file(points + "data/0000000003.bin"),
                          folder.file(points + "data/0000000009.bin"));
  EXPECT_EQ(3U, convert(folder, "KITTI-360").poses);
  EXPECT_NEAR(1369730763.216, readAll(folder.file("x.rawlog")).at(3).scan.stamp, 1e-6);
  // More than there are scans: one for each number.
  std::string all;
  for (const char* second : {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9"})
  {
    all += "2013-05-28 08:46:0" + std::string(second) + ".5\n";
  }
  folder.write(points + "timestamps.txt", all);
  EXPECT_EQ(3U, convert(folder, "KITTI-360").poses);
  EXPECT_NEAR(1369730769.5, readAll(folder.file("x.rawlog")).at(3).scan.stamp, 1e-6);

  std::filesystem::remove(folder.file(points + "timestamps.txt"));
  const auto result = convert(folder, "KITTI-360");
  EXPECT_TRUE(contains(result.warnings.at(0), "data_3d_timestamps.zip")) << result.warnings[0];
}

TEST(Kitti360, TruthThatIsMissingIsAWarning)
{
  const TestFolder folder;
  writeDrive(folder);
  const std::string poses = "KITTI-360/data_poses/" + std::string(drive_name) + "/poses.txt";
  const auto warning = [&]
  {
    const auto result = convert(folder, drivePath());
    EXPECT_EQ(4U, result.scans);
    EXPECT_EQ(0U, result.poses);
    return result.warnings.empty() ? "" : result.warnings.front();
  };
  folder.write(poses, imuPose(7, 100) + imuPose(9, 105));
  EXPECT_TRUE(contains(warning(), "has poses of frames 7 to 9, none of the scans 0 to 3"));
  std::filesystem::remove(folder.file("KITTI-360/calibration/calib_cam_to_pose.txt"));
  EXPECT_TRUE(contains(warning(), "calib_cam_to_pose.txt"));
  std::filesystem::remove_all(folder.file("KITTI-360/calibration"));
  EXPECT_TRUE(contains(warning(), "KITTI-360/calibration has no calib_cam_to_velo.txt"));
  KittiConverterOptions options = optionsOf360();
  options.poses = folder.file(poses);
  EXPECT_TRUE(contains(messageOf(folder, drivePath(), options), "--calib"));
  std::filesystem::remove(folder.file(poses));
  EXPECT_TRUE(contains(warning(), "converted without true poses: no")) << warning();
  options.poses.clear();
  options.no_truth = true;
  EXPECT_TRUE(convert(folder, drivePath(), options).warnings.empty());
}

TEST(Kitti360, AWrongDriveKindOrOption)
{
  const TestFolder folder;
  writeDrive(folder);
  KittiConverterOptions options = optionsOf360();
  options.sequence = "0004";
  EXPECT_TRUE(contains(messageOf(folder, "KITTI-360", options),
                       "has no scans of drive 0004; choose one with --sequence, such as 2013_05"));
  EXPECT_TRUE(contains(messageOf(folder, drivePath(), options), "leave --sequence out"));
  writeBins(folder, drivePath("2013_05_28_drive_0004_sync/velodyne_points/data"), 1, 10);
  EXPECT_EQ(1U, convert(folder, "KITTI-360", options).scans);
  options.sequence.clear();
  EXPECT_TRUE(contains(messageOf(folder, "KITTI-360", options), "holds 2 drives; choose one"));

  options.kind = KittiKind::raw;
  EXPECT_TRUE(contains(messageOf(folder, drivePath(), options), "use --kind 360"));
  EXPECT_TRUE(contains(messageOf(folder, "KITTI-360", options), "--kind 360 -i"));
  EXPECT_TRUE(contains(messageOf(folder, "KITTI-360/data_3d_raw", options), "--kind 360 -i"));
  EXPECT_TRUE(contains(
      messageOfError<UserError>([&] { (void)RecordingConverter(folder.file("KITTI-360")); }),
      "give one of the recordings in it, such as"));

  options = optionsOf360();
  const std::string raw = writeRawDrive(folder);
  EXPECT_TRUE(contains(messageOf(folder, raw, options), "use --kind raw"));
  options.calib = folder.file("KITTI-360/data_3d_raw");
  EXPECT_TRUE(contains(messageOf(folder, drivePath(), options), "folder calibration"));
  options.calib.clear();
  options.imu = true;
  EXPECT_TRUE(contains(messageOf(folder, drivePath(), options), "--imu: the oxts of KITTI-360"));
}
}  // namespace dyslam
