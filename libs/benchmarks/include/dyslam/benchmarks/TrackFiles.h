// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/eval/TrackErrors.h>
#include <dyslam/eval/TrackMetrics.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Which true boxes count for a tracker of moving objects visible to the LiDAR. */
struct TrackSelection
{
  int min_points = 10;     //!< least number of points of the box's instance in the scan
  double min_speed = 0.5;  //!< least true speed [m/s]
  double max_range = 60;   //!< largest horizontal distance [m]
  /** Horizontal field of view, centred ahead [deg]. By default the view of KITTI's camera if the
   * true boxes are from its images (they have rectangles), else all around. */
  std::optional<double> view;
  int first_frame = 0;  //!< earlier frames are removed
  /** Instance in the labels minus track id; by default 0 or 1, whichever gives more boxes points.
   */
  std::optional<int> instance_offset;
};

/** Tracks of a recording with their known speeds. */
struct TrackData
{
  std::vector<LabelledBox> boxes;
  TrackSpeeds speeds;
  CentresByFrame hidden;  //!< of the truth: where objects were while they had no box
};

/** Reads the ground truth of a recording: a folder with tracks.txt and optionally poses_tum.txt
 * (for speeds and hidden objects; requires the rawlog next to the folder) and labels/ (for the
 * points per box). Boxes that the selection does not count are marked as ignored, those before its
 * first frame removed.
 * \param selection its defaults are replaced by the values for this ground truth.
 * \param note called if the rawlog is damaged, if its scans have no poses, and if poses or labels
 * are missing that the selection needs \throws UserError for files that are missing or cannot be
 * read. */
[[nodiscard]] TrackData readTruth(const std::string& folder,
                                  TrackSelection& selection,
                                  const NoteSink& note);

/** Reads the tracks of a run: tracks.txt, and speeds from tracks.csv.
 * \throws UserError for files that are missing or cannot be read. */
[[nodiscard]] TrackData readRun(const std::string& folder);

/** Removes the estimates that the selection of true boxes does not cover: before its first frame,
 * and those beyond its view and range, or within 2 m of a hidden object, unless they are within 2 m
 * of a true box that counts. \param truth result of readTruth() */
void removeUncovered(std::vector<LabelledBox>& estimates,
                     const TrackData& truth,
                     const TrackSelection& selection);

/** Indices of the first and last scan that a run processed (Frame::index). */
struct FrameRange
{
  int first = 0;
  int last = 0;
};
/** From scans.csv, which counts scans that were dropped for their time stamps; without one from
 * report and ini, as if none was. Nothing for a folder that has neither.
 * \throws UserError for files that cannot be read. */
[[nodiscard]] std::optional<FrameRange> processedFrames(const std::string& folder);

/** Vehicle for car, van, truck and bus; Cyclist for two-wheelers; otherwise unchanged. */
[[nodiscard]] std::string mergedType(const std::string& type);
void mergeTypes(std::vector<LabelledBox>& boxes);
}  // namespace dyslam
