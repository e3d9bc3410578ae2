// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Georeference.h>
#include <dyslam/core/Gravity.h>
#include <dyslam/core/PriorMapFit.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Result of a run; report.json (RunReport) has it with the run's input, times and memory. */
struct SlamRunReport
{
  std::string method;  //!< stages in use, e.g. "residual + constant_velocity + point_to_plane"
  std::size_t frames = 0;
  std::size_t unconverged = 0;      //!< number of frames whose motion was predicted, not measured
  std::size_t odometry_failed = 0;  //!< number of frames on which odometry.method found no motion
  std::size_t keyframes = 0;
  std::size_t loops = 0;           //!< number of loops in use
  std::size_t loops_left_out = 0;  //!< number of loops that contradict the others and the odometry
  /** Pose of the map on the earth; nothing if satellite positions don't show it. */
  std::optional<Georeference> georeference;
  std::optional<Gravity> gravity;
  std::optional<PriorMapFit> prior_map;  //!< nothing without a prior map
  std::size_t tracks = 0;                //!< number of confirmed moving objects
  /** Number of all reported objects, also of those that are never moving: the ids of tracks.csv. */
  std::size_t reported_tracks = 0;
  std::size_t map_points = 0;
  double path_length = 0;  //!< length of the trajectory [m]
  double ms_per_scan = 0;  //!< mean time of all stages, without reading and writing files
  /** From the construction of SlamRun to its last file, including the first of two passes [s]. */
  double run_time = 0;
  double first_pass_time = 0;  //!< part of run_time for the first of two passes [s]
  double recording_time = 0;   //!< duration of the processed part of the recording [s]
  bool has_reference = false;  //!< the recording had ground truth; reference_tum.txt was written
  /** How far the result can be trusted: usable, doubtful (the warnings say why) or unusable. */
  std::string verdict = "usable";
  /** Why the result is unusable: most scans could not be registered; empty if it is usable. */
  std::string failure;
  /** Why the run ended before the last scan (stopped, or the recording is damaged); empty if it did
   * not. Also one of the warnings. */
  std::string ended_early;
  /** Advice to process the recording in two passes because of dense traffic; else empty. Also one
   * of the warnings. */
  std::string second_pass_advice;
  std::vector<std::string> warnings;
  std::vector<std::string> files;  //!< names of the files written to the output folder

  /** Recording time over run time; 1 and more is real time. 0 if unknown. */
  [[nodiscard]] double realtimeFactor() const
  {
    return run_time > 0 ? recording_time / run_time : 0;
  }
};
}  // namespace dyslam
