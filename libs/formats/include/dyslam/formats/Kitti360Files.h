// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/formats/KittiFiles.h>

#include <map>
#include <string>

namespace dyslam
{
/** Whether a folder is the `calibration` of KITTI-360. */
[[nodiscard]] bool isKitti360Calib(const std::string& folder);

/** Reads the `calibration` folder of KITTI-360: `calib_cam_to_velo.txt`, and where they are there
 * `calib_cam_to_pose.txt` for T_velo_imu and `perspective.txt` for the rectified camera 0. "IMU" is
 * the frame of `poses.txt`, x ahead, y right, z down. \throws UserError. */
[[nodiscard]] KittiCalib readKitti360Calib(const std::string& folder);

/** Poses of KITTI-360 by the number of their frame; not every frame has one. */
struct Kitti360Poses
{
  std::map<int, Pose> of_frame;  //!< T_world_imu, or T_world_camera
  bool are_of_camera = false;    //!< of the rectified camera 0, else of the IMU
};

/** Whether the first line of a file is one of KITTI-360's poses: the number of a frame and a 3x4 or
 * 4x4 matrix. \throws UserError if the file cannot be read. */
[[nodiscard]] bool hasKitti360Poses(const std::string& path);

/** Reads `poses.txt` (13 numbers a line: frame, 3x4 matrix) or `cam0_to_world.txt` (17 numbers:
 * frame, 4x4 matrix). \throws UserError. */
[[nodiscard]] Kitti360Poses readKitti360Poses(const std::string& path);
}  // namespace dyslam
