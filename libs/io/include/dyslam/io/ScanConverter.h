// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/io/Conversion.h>
#include <dyslam/io/RecordingOptions.h>

#include <string>

namespace dyslam
{
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
  /** As requireFitting(), of all options. \throws UserError also for options that exclude each
   * other. */
  void requireAllFitting(RecordingKind kind) const;
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
}  // namespace dyslam
