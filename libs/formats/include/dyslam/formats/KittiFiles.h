// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Rigid transformations between the sensors from KITTI's calibration files.
 *
 * "Camera" is the rectified camera 0, in whose frame labels and odometry poses are given.
 */
struct KittiCalib
{
  Pose T_cam_velo = Pose::Identity();  //!< lidar points to the rectified camera 0
  Pose T_velo_imu = Pose::Identity();  //!< GNSS/INS frame to the lidar
  bool has_imu = false;
  bool has_camera = true;
  Eigen::Matrix<double, 3, 4> P2 = Eigen::Matrix<double, 3, 4>::Zero();  //!< colour camera's
};

/** Reads an odometry (`Tr`), tracking or object (`R_rect`/`R0_rect`, `Tr_velo_cam`/
 * `Tr_velo_to_cam`, `Tr_imu_velo`/...) calib file, or a raw day's folder with
 * `calib_velo_to_cam.txt` and `calib_cam_to_cam.txt`, `calib_imu_to_velo.txt`, or all three (or one
 * of them, for its folder).
 * \throws UserError, also for a matrix that is not a rotation.
 */
[[nodiscard]] KittiCalib readKittiCalib(const std::string& file_or_folder);

/** timestamps.txt of a raw drive: a line such as `2011-09-26 13:02:25.951199337`, taken as UTC, for
 * each frame number [s since 1970]; NaN for an empty line, KITTI's mark of a lost scan. Empty lines
 * at the end are left out. \throws UserError. */
[[nodiscard]] std::vector<double> readKittiTimestamps(const std::string& path);

/** Either that or a number a line [s], whichever the first line with content is.
 * \throws UserError. */
[[nodiscard]] std::vector<double> readTimesOrTimestamps(const std::string& path);

/** One GNSS/INS reading: those of the 30 numbers of KITTI's oxts that are used. */
struct OxtsReading
{
  double latitude = 0;           //!< [deg]
  double longitude = 0;          //!< [deg]
  double altitude = 0;           //!< [m]
  double roll = 0;               //!< [rad]
  double pitch = 0;              //!< [rad]
  double yaw = 0;                //!< [rad], 0 = east, counter-clockwise
  double position_accuracy = 0;  //!< [m]
  // About and along the axes of the unit: x forward, y left, z up.
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  //!< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      //!< with gravity [m/s^2]
};

/** Tracking's one file for all frames, or raw's folder (`oxts/data/NNNNNNNNNN.txt`, `oxts/` or
 * `data/`). \throws UserError. */
[[nodiscard]] std::vector<OxtsReading> readOxts(const std::string& file_or_folder);

/** Poses of the IMU in its first pose's frame, by the Mercator projection of KITTI's development
 * kit (scale from the first latitude). The first is the identity. */
[[nodiscard]] std::vector<Pose> oxtsPoses(const std::vector<OxtsReading>& readings);

/** Poses of the lidar in the first lidar's frame from those of the IMU. */
[[nodiscard]] std::vector<Pose> imuToLidarPoses(const std::vector<Pose>& poses,
                                                const Pose& T_velo_imu);

/** Box in KITTI's camera frame: x right, y down, z ahead. */
struct CameraBox
{
  Eigen::Vector3d bottom = Eigen::Vector3d::Zero();  //!< centre of the bottom face [m]
  double height = 0;                                 //!< [m]
  double width = 0;                                  //!< [m]
  double length = 0;                                 //!< [m]
  double ry = 0;                                     //!< heading about y, 0 along x [rad]
};
/** The same box, upright in the other frame: the two differ in tilt by less than a degree, which
 * the heading ignores. */
[[nodiscard]] Box toLidar(const CameraBox& box, const Pose& T_cam_velo);

/** Tracking labels (`label_02/NNNN.txt`, 17 columns, or results with score in an 18th) with boxes
 * in the lidar's frame. \param keep_dont_care keeps the DontCare regions, whose boxes mean nothing.
 * \throws UserError. */
[[nodiscard]] std::vector<LabelledBox> readKittiTracking(const std::string& path,
                                                         const Pose& T_cam_velo,
                                                         bool keep_dont_care = false);

/** 3D detections as AB3DMOT's csv: frame,type,x1,y1,x2,y2,score,h,w,l,x,y,z,ry,alpha with type 1
 * pedestrian, 2 car, 3 cyclist. Boxes in the lidar's frame, id -1. \throws UserError. */
[[nodiscard]] std::vector<LabelledBox> readDetectionsCsv(const std::string& path,
                                                         const Pose& T_cam_velo);
}  // namespace dyslam
