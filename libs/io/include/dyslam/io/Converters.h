// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/formats/Bag.h>
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
/** Called after every scan with the fraction of the work done (0 to 1) and the number of scans. An
 * exception from it ends the conversion and removes all that was written. */
using ConversionProgress = std::function<void(double, std::size_t)>;

struct ConversionResult
{
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t poses = 0;           //!< number of scans with a true pose
  std::string pose_source;         //!< file of the true poses; empty without
  std::size_t label_files = 0;     //!< number of scans with labels per point
  std::size_t boxes = 0;           //!< number of true boxes of all scans
  std::string ground_truth;        //!< sidecar folder; empty if there is no truth
  std::vector<std::string> notes;  //!< inputs that were found and used, a line each
  std::vector<std::string> warnings;
};

/** Options of every conversion: the scans that are converted, and the form of the rawlog. */
struct ConversionOptions : ScanRange
{
  int every_n = 1;                //!< of the scans behind those skipped, every n-th is converted
  bool external_storage = false;  //!< as in RawlogWriterOptions
  int compression_level = 1;      //!< as in RawlogWriterOptions

  void describeConversion(OptionsVisitor& visitor);
};

/** Whether scans are already deskewed; deskewed scans get point times of 0. */
enum class ScansDeskewed
{
  automatic,  //!< scans of KITTI odometry are deskewed
  yes,
  no
};

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

struct ScanConverterOptions : Options, ConversionOptions, RecordingOptions
{
  std::string poses;  //!< TUM or KITTI file of lidar poses, for folders
  std::string times;  //!< file of times [s] or KITTI time stamps for a folder, one line per scan
  std::string truth_topic;  //!< topic of a bag's true vehicle poses; empty: none
  std::string truth_frame;  //!< child frame of truth_topic, if it has several
  PoseSource pose_source = PoseSource::unknown;  //!< source of true poses; unknown: given
  /** T_vehicle_imu, in the format of sensor_pose; empty: by `/tf_static` and sensor_pose. */
  std::string imu_pose;
  bool by_number = false;     //!< time of a scan of a folder: dt times the number in its name
  bool keep_partial = false;  //!< write also incomplete first and last revolutions of a pcap

  void describe(OptionsVisitor& visitor) override;
};

/** Writes a folder of .bin, .pcd or .ply scans, a Velodyne .pcap or a ROS bag (see openBag()) as a
 * rawlog, with the IMU and the wheel odometry of a bag if the options name their topics, and the
 * IMU in the Ouster of a .pcap if they ask for it. Scans of a folder get the times of the file, of
 * their names where those are times since 1970, or of their points. \param unpacking of a bag that
 * is compressed as a whole, before the first scan; see openBag() \throws UserError. */
ConversionResult convertScans(const std::string& input,
                              const std::string& output,
                              const ScanConverterOptions& options,
                              const ConversionProgress& progress = {},
                              const BagUnpackingProgress& unpacking = {});

/** T_vehicle_sensor of "x y z yaw pitch roll" [m, deg], separated by spaces or commas; identity if
 * empty. \param option for messages: "--sensor-pose". \throws UserError. */
[[nodiscard]] Pose poseFromOption(const std::string& option, const std::string& text);
}  // namespace dyslam
