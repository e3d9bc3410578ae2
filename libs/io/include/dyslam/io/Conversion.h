// SPDX-License-Identifier: BSD-3-Clause
// What the conversions of recordings to rawlogs have in common.
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Pose.h>
#include <dyslam/io/ScanRange.h>

#include <cstddef>
#include <functional>
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
  bool growing =
      false;  //!< as in RawlogWriterOptions, with a flush() after each scan; not in an ini

  void describeConversion(OptionsVisitor& visitor);
};

/** T_vehicle_sensor of "x y z yaw pitch roll" [m, deg], separated by spaces or commas; identity if
 * empty. \param option for messages: "--sensor-pose". \throws UserError. */
[[nodiscard]] Pose poseFromOption(const std::string& option, const std::string& text);
}  // namespace dyslam
