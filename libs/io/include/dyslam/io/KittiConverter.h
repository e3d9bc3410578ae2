// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/Conversion.h>
#include <dyslam/io/RecordingOptions.h>

#include <string>

namespace dyslam
{
/** Frame of the poses of a pose file. */
enum class PoseFrame
{
  automatic,  //!< camera for poses of KITTI odometry; lidar for files named velo or lidar;
              //!< of KITTI-360 the IMU or the camera, as its files have them
  lidar,
  camera
};

struct KittiConverterOptions : Options, ConversionOptions
{
  KittiKind kind = KittiKind::odometry;
  std::string calib;   //!< calibration file or folder; empty: that of the layout
  std::string poses;   //!< TUM, KITTI or KITTI-360 file of true poses
  std::string oxts;    //!< GNSS/INS readings: file or folder
  std::string labels;  //!< folder of .label files
  std::string boxes;   //!< label_02 file, or folder of SUSTechPOINTS json
  /** Sequence of KITTI tracking, "0000", or drive of KITTI-360, "0000" or the name of its folder;
   * empty: the only one. */
  std::string sequence;
  std::string times;        //!< file of times [s] or KITTI time stamps, one line per frame number
  std::string sensor_pose;  //!< T_vehicle_lidar: x y z yaw pitch roll [m, deg]; empty: identity
  bool imu = false;         //!< write angular velocities and accelerations of oxts
  bool gnss = false;        //!< write positions of oxts
  bool no_truth = false;    //!< write only scans, without poses, labels and boxes
  PoseFrame pose_frame = PoseFrame::automatic;
  PoseSource pose_source = PoseSource::unknown;  //!< source of the poses; unknown: by the files
  ScansDeskewed deskewed = ScansDeskewed::automatic;
  double dt = 0;  //!< time between scans [s]; 0: times of the layout, else 0.1034
  bool vertical_angle_correction = false;  //!< raise the points by 0.205 deg about the sensor

  void describe(OptionsVisitor& visitor) override;
};

/** Writes a KITTI folder, official (of KITTI-360 also the folder of its drives) or plain
 * (`velodyne/NNNNNN.bin` and whatever files the options name), as a rawlog with its ground-truth
 * sidecar. Every point is kept in its order.
 *
 * Ground truth in the folder that cannot be read, for example without calibration, is left out with
 * a warning; ground truth that the options name must be readable.
 *
 * The vehicle frame is the lidar's unless sensor_pose is given, the world frame is that of the pose
 * file. Frames are counted from 0 as in the rawlog. \throws UserError. */
ConversionResult convertKitti(const std::string& input,
                              const std::string& output,
                              const KittiConverterOptions& options,
                              const ConversionProgress& progress = {});
}  // namespace dyslam
