// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/Converters.h>

#include <optional>
#include <string>

namespace dyslam
{
/** Options for a recording of any kind; all others are those of the converter alone. */
struct RecordingOptions
{
  std::string topic;           //!< as in ScanConverterOptions, of a bag
  std::string imu_topic;       //!< as in ScanConverterOptions, of a bag
  std::string odometry_topic;  //!< as in ScanConverterOptions, of a bag
  std::string gnss_topic;      //!< as in ScanConverterOptions, of a bag
  std::string sensor;          //!< as in ScanConverterOptions, not of KITTI
  std::string calibration;     //!< as in ScanConverterOptions, not of KITTI
  std::string sensor_pose;     //!< T_vehicle_lidar: x y z yaw pitch roll [m, deg]; empty: identity
  std::string base_frame;      //!< as in ScanConverterOptions, of a bag
  double dt = 0;               //!< seconds between scans; 0: the recording's times

  /** The flag of an option that is given, for messages: "--topic"; empty if none is. */
  [[nodiscard]] std::string givenFlag() const;
};

/** Converts a recording that is no rawlog by the converter that fits: convertScans() or
 * convertKitti(), chosen by recordingKind() alone. */
class RecordingConverter
{
 public:
  /** \throws UserError for a folder that no converter reads. */
  explicit RecordingConverter(const std::string& input);

  /** Whether there is something to convert; false for a file that may be a rawlog. */
  [[nodiscard]] bool isNeeded() const { return needed_; }
  /** The program that does the same: "kitti2rawlog --kind raw" or "scans2rawlog". */
  [[nodiscard]] std::string program() const;
  /** \pre isNeeded() \throws UserError, also for options that do not apply to the recording. */
  ConversionResult convert(const std::string& output,
                           const RecordingOptions& options,
                           const ConversionProgress& progress = {}) const;

 private:
  std::string input_;
  std::optional<KittiKind> kitti_;  //!< nothing: no KITTI recording
  bool needed_;
};
}  // namespace dyslam
