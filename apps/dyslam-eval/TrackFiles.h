// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/TrackErrors.h>
#include <dyslam/eval/TrackMetrics.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Which true boxes a tracker of moving things seen by the LiDAR is judged on. */
struct TrackSelection
{
  int min_points = 10;      //!< of the box's instance in the scan
  double min_speed = 0.5;   //!< [m/s]
  double max_range = 60;    //!< [m]
  double view = 360;        //!< boxes outside this angle, centred ahead, are left out [deg]
  int first_frame = 0;      //!< earlier frames are left out
  int instance_offset = 0;  //!< label's instance minus the track's id
};

/** Tracks of a recording with what is known of their speeds. */
struct TrackData
{
  std::vector<LabelledBox> boxes;
  TrackSpeeds speeds;
};

/** Ground truth of a recording: a folder with tracks.txt and, where there are, poses_tum.txt (for
 * speeds, with the rawlog beside the folder) and labels/ (for points per box). What the selection
 * does not count is marked as passed over. \throws UserError. */
[[nodiscard]] TrackData readTruth(const std::string& folder, const TrackSelection& selection);

/** Folder of a run: tracks.txt, and speeds from tracks.csv. \throws UserError. */
[[nodiscard]] TrackData readRun(const std::string& folder, const TrackSelection& selection);

/** Numbers of the scans that a run went over, by its report and config; nothing for a folder
 * without them. */
struct FrameRange
{
  int first = 0;
  int last = 0;
};
[[nodiscard]] std::optional<FrameRange> processedFrames(const std::string& folder);

/** Car, van, truck, bus: Vehicle; all on two wheels: Cyclist; others as they are. */
[[nodiscard]] std::string mergedType(const std::string& type);
void mergeTypes(std::vector<LabelledBox>& boxes);
}  // namespace dyslam
