// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/RecordingOptions.h>
#include <dyslam/io/ScanRange.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Called after every scan: fraction of the work done (0 to 1) and scans so far. An exception from
 * it ends the conversion and removes all that was written. */
using ConversionProgress = std::function<void(double, std::size_t)>;

struct ConversionResult
{
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t poses = 0;           //!< scans with a true pose
  std::string pose_source;         //!< the file they are from; empty without
  std::size_t label_files = 0;     //!< scans with labels per point
  std::size_t boxes = 0;           //!< true boxes of all scans
  std::string ground_truth;        //!< sidecar folder; empty if there is no truth
  std::vector<std::string> notes;  //!< inputs that were found and used, a line each
  std::vector<std::string> warnings;
};

/** Whether scans are deskewed already; such scans are given point times of 0. */
enum class ScansDeskewed
{
  automatic,  //!< KITTI odometry's are
  yes,
  no
};

/** Which frame the poses of a pose file are in. */
enum class PoseFrame
{
  automatic,  //!< camera for odometry's own poses, lidar if the file's name says velo or lidar
  lidar,
  camera
};

struct KittiConverterOptions : Options, ScanRange
{
  KittiKind kind = KittiKind::odometry;
  std::string calib;     //!< file or folder; empty: where the layout has it
  std::string poses;     //!< TUM or KITTI file
  std::string oxts;      //!< file or folder
  std::string labels;    //!< folder of .label files
  std::string boxes;     //!< label_02 file, or folder of SUSTechPOINTS json
  std::string sequence;  //!< of tracking's official layout: "0000"; empty: the only one
  std::string times;     //!< file of times [s] or KITTI time stamps, a line for each frame number
  std::string sensor_pose;  //!< T_vehicle_lidar: x y z yaw pitch roll [m, deg]; empty: identity
  bool imu = false;         //!< with the angular velocities and accelerations of oxts
  bool gnss = false;        //!< with the positions of oxts
  bool no_truth = false;    //!< scans only: no poses, labels or boxes
  PoseFrame pose_frame = PoseFrame::automatic;
  PoseSource pose_source = PoseSource::unknown;  //!< of the poses; unknown: by the files
  ScansDeskewed deskewed = ScansDeskewed::automatic;
  double dt = 0;  //!< seconds between scans; 0: the layout's own times, else 0.1034
  bool vertical_angle_correction = false;  //!< lifts the points by 0.205 deg about the sensor
  int every_n = 1;  //!< of the scans behind those skipped, every n-th is converted
  bool external_storage = false;
  int compression_level = 1;

  void describe(OptionsVisitor& visitor) override;
};

/** Writes a KITTI folder, official or plain (`velodyne/NNNNNN.bin` and whatever files the options
 * name), as a rawlog with its ground-truth sidecar. Every point is kept in its order.
 *
 * Truth that lies in the folder but cannot be read, because the calibration is missing for example,
 * is left out with a warning; truth that the options name must be readable.
 *
 * The vehicle frame is the lidar's unless sensor_pose says otherwise, the world that of the pose
 * file. Boxes and labels keep their
 * meaning, frames are counted from 0 as in the rawlog. \throws UserError. */
ConversionResult convertKitti(const std::string& input,
                              const std::string& output,
                              const KittiConverterOptions& options,
                              const ConversionProgress& progress = {});

struct ScanConverterOptions : Options, ScanRange, RecordingOptions
{
  std::string poses;  //!< TUM or KITTI file of the lidar, for folders
  std::string times;  //!< file of times [s] or KITTI time stamps for a folder, a line for each scan
  std::string truth_topic;  //!< of a bag's true poses of the vehicle; empty: none
  std::string truth_frame;  //!< child frame of truth_topic, where that has several
  PoseSource pose_source = PoseSource::unknown;  //!< of poses or truth_topic; unknown: given
  /** T_vehicle_imu as sensor_pose; empty: by the bag's `/tf_static` and sensor_pose. */
  std::string imu_pose;
  std::optional<BinLayout> bin_layout;  //!< of .bin files; nothing: by their content
  bool by_number = false;     //!< scans of a folder are dt times the number in their name apart
  bool keep_partial = false;  //!< also incomplete first and last revolutions of a pcap
  int every_n = 1;            //!< of the scans behind those skipped, every n-th is converted
  bool external_storage = false;
  int compression_level = 1;

  void describe(OptionsVisitor& visitor) override;
};

/** Writes a folder of .bin, .pcd or .ply scans, a Velodyne .pcap or a ROS bag (see openBag()) as a
 * rawlog, with the IMU and the wheel odometry of a bag if the options name their topics. Scans of a
 * folder get the times of the file, of their names where those are times since 1970, or of their
 * points. \throws UserError. */
ConversionResult convertScans(const std::string& input,
                              const std::string& output,
                              const ScanConverterOptions& options,
                              const ConversionProgress& progress = {});

/** T_vehicle_sensor of "x y z yaw pitch roll" [m, deg], separated by spaces or commas; identity if
 * empty. \param option for messages: "--sensor-pose". \throws UserError. */
[[nodiscard]] Pose poseFromOption(const std::string& option, std::string text);
}  // namespace dyslam
