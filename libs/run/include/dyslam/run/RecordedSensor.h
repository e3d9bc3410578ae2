// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/ScanPattern.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct RawlogSourceOptions;

/** Properties of a lidar, measured from the first scans of a recording that have many returns. */
struct RecordedSensor
{
  ScanPattern pattern;     //!< pattern of the scan with most rings
  double share_above = 0;  //!< share of its returns above the lidar, along the vehicle's z
  /** Ground plane in axes of the recording's vehicle frame, origin at the lidar; nothing if the
   * scans show no ground or do not agree. */
  std::optional<GroundPlane> ground;
  double period = 0;         //!< median time between scans [s]; 0 for a single scan
  bool has_times = false;    //!< points have times, even if all the same (deskewed before)
  bool equal_times = false;  //!< points have times, but the same for all points of a scan
  std::size_t scans = 0;     //!< number of scans examined

  /** Text such as "16 rings, 2.0 deg apart, -15.0 to 15.0 deg, to 98 m, 10.0 Hz". */
  [[nodiscard]] std::string summary() const;
  /** Sentence about missing or equal point times, the consequence and the remedy; empty if times
   * are not missing. \param deskew value of preprocess.deskew */
  [[nodiscard]] std::string missingTimes(const std::string& deskew) const;
  /** missingTimes() with preprocess.deskew of a run's config. */
  [[nodiscard]] std::string missingTimes(const Config& config) const;
};

/** Recognises the sensor from the first scans of a rawlog: up to fifty, until five of them have
 * many returns; fifty if the ground is inclined. The scans are in the vehicle frame of the
 * recording: roll and pitch of the options are ignored. \throws UserError if there is no scan. */
[[nodiscard]] RecordedSensor recogniseSensor(const std::string& rawlog,
                                             const RawlogSourceOptions& input);

/** Recognises the sensor from the first scans of a live sensor; five with many returns suffice.
 * \param frames only `scan` is read \throws std::invalid_argument without a frame. */
[[nodiscard]] RecordedSensor recogniseSensor(const std::vector<Frame>& frames);
}  // namespace dyslam
