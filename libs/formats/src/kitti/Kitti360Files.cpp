// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/Kitti360Files.h>
#include <dyslam/formats/TextFile.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "CalibEntries.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr const char* camera_to_lidar_file = "calib_cam_to_velo.txt";
constexpr const char* cameras_to_imu_file = "calib_cam_to_pose.txt";
constexpr const char* rectification_file = "perspective.txt";

constexpr std::size_t fields_of_imu_pose = 13;
constexpr std::size_t fields_of_camera_pose = 17;

/** The 3x4 matrix that a file has and nothing else, in one line or several. */
Pose readMatrix(const std::string& path)
{
  TextFile file(path);
  std::vector<double> values;
  while (file.next())
  {
    const std::vector<double> line = file.numbers();
    values.insert(values.end(), line.begin(), line.end());
  }
  if (values.size() != 12)
  {
    throw UserError(path + ": has " + std::to_string(values.size()) +
                    " numbers, needs 12 (a 3x4 matrix row by row)");
  }
  return poseFromRows(values, 4, path + ": the matrix");
}
}  // namespace

bool isKitti360Calib(const std::string& folder)
{
  return fs::exists(fs::path(folder) / camera_to_lidar_file);
}

KittiCalib readKitti360Calib(const std::string& folder)
{
  const Pose T_velo_cam = readMatrix((fs::path(folder) / camera_to_lidar_file).string());
  KittiCalib calib;
  const fs::path imu = fs::path(folder) / cameras_to_imu_file;
  calib.has_imu = fs::exists(imu);
  if (calib.has_imu)
  {
    const Pose T_imu_cam = CalibEntries(imu.string()).pose({"image_00"}, 4);
    calib.T_velo_imu = T_velo_cam * T_imu_cam.inverse();
  }
  const fs::path camera = fs::path(folder) / rectification_file;
  calib.has_camera = fs::exists(camera);
  if (calib.has_camera)
  {
    const Pose T_rectified_cam = CalibEntries(camera.string()).pose({"R_rect_00"}, 3);
    calib.T_cam_velo = T_rectified_cam * T_velo_cam.inverse();
  }
  return calib;
}

bool hasKitti360Poses(const std::string& path)
{
  constexpr double first_date = 1e8;  // [s] in 1973; poses by time have such numbers
  TextFile file(path);
  if (!file.next() ||
      (file.fields().size() != fields_of_imu_pose && file.fields().size() != fields_of_camera_pose))
  {
    return false;
  }
  const std::optional<double> frame = parseNumber<double>(file.fields().front());
  return frame && *frame < first_date;
}

Kitti360Poses readKitti360Poses(const std::string& path)
{
  TextFile file(path);
  Kitti360Poses poses;
  std::size_t fields = 0;
  while (file.next())
  {
    if (fields == 0)
    {
      poses.are_of_camera = file.fields().size() == fields_of_camera_pose;
      fields = poses.are_of_camera ? fields_of_camera_pose : fields_of_imu_pose;
    }
    file.requireFields(fields, poses.are_of_camera ? "a frame's number, then a 4x4 matrix"
                                                   : "a frame's number, then a 3x4 matrix");
    const int frame = file.integer(0);
    const Pose pose = poseFromRows(file.numbers(1), 4, file.position() + ": the matrix");
    if (!poses.of_frame.emplace(frame, pose).second)
    {
      file.fail("frame " + std::to_string(frame) + " has a pose in an earlier line, too");
    }
  }
  if (poses.of_frame.empty())
  {
    throw UserError(path + ": holds no poses");
  }
  return poses;
}
}  // namespace dyslam
