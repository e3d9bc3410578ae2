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
  Eigen::Matrix<double, 3, 4> P2 = Eigen::Matrix<double, 3, 4>::Zero();  //!< colour camera
};

/** Reads an odometry (`Tr`), tracking or object (`R_rect`/`R0_rect`, `Tr_velo_cam`/
 * `Tr_velo_to_cam`, `Tr_imu_velo`/...) calib file, or a raw day's folder with
 * `calib_velo_to_cam.txt` and `calib_cam_to_cam.txt`, `calib_imu_to_velo.txt`, or all three (or one
 * of them, for its folder), or KITTI-360's `calibration` (see readKitti360Calib()).
 * \throws UserError, also for a matrix that is not a rotation.
 */
[[nodiscard]] KittiCalib readKittiCalib(const std::string& file_or_folder);

/** Reads timestamps.txt of a raw drive: a line such as `2011-09-26 13:02:25.951199337` per frame
 * number, interpreted as UTC. \return UNIX times [s]; NaN for an empty line (lost scan). Empty
 * lines at the end are ignored. \throws UserError. */
[[nodiscard]] std::vector<double> readKittiTimestamps(const std::string& path);

/** Reads time stamps as readKittiTimestamps(), or one number per line [s], decided by the first
 * line with content. \throws UserError. */
[[nodiscard]] std::vector<double> readTimesOrTimestamps(const std::string& path);

/** One GNSS/INS reading: the numbers that are used of the 30 of KITTI's oxts. */
struct OxtsReading
{
  double latitude = 0;           //!< [deg]
  double longitude = 0;          //!< [deg]
  double altitude = 0;           //!< height [m]
  double roll = 0;               //!< [rad]
  double pitch = 0;              //!< [rad]
  double yaw = 0;                //!< [rad], 0 = east, counter-clockwise
  double position_accuracy = 0;  //!< sigma of the position [m]
  // In the axes of the unit: x forward, y left, z up.
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  //!< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      //!< with gravity [m/s^2]
};

/** Reads oxts: one file for all frames (tracking), or a folder (raw: `oxts/data/NNNNNNNNNN.txt`,
 * `oxts/` or `data/`). \throws UserError. */
[[nodiscard]] std::vector<OxtsReading> readOxts(const std::string& file_or_folder);

/** Poses of the IMU in its first pose's frame, by the Mercator projection of KITTI's development
 * kit (scale from the first latitude). The first is the identity. */
[[nodiscard]] std::vector<Pose> oxtsPoses(const std::vector<OxtsReading>& readings);

/** Box in KITTI's camera frame: x right, y down, z ahead. */
struct CameraBox
{
  Eigen::Vector3d bottom = Eigen::Vector3d::Zero();  //!< centre of the bottom face [m]
  double height = 0;                                 //!< [m]
  double width = 0;                                  //!< [m]
  double length = 0;                                 //!< [m]
  double ry = 0;                                     //!< heading about y, 0 along x [rad]
};
/** The box in the lidar frame, upright there: the frames differ in tilt by less than a degree,
 * which the heading ignores. */
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
