// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/benchmarks/TrackFiles.h>
#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrackMetrics.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Files of the tracks that are compared. */
struct TrackSources
{
  std::string reference;  //!< ground-truth folder of a recording, or a file of tracks
  std::string estimate;   //!< output folder of a run, or a file of tracks
  /** Calibration of KITTI files in the camera frame, whose image rules then apply; empty for files
   * in the lidar frame. */
  std::string calib;
};

/** Conditions under which a true and an estimated box may match. */
struct TrackMatching
{
  double min_iou = 0.25;    //!< least 3D IoU
  double max_distance = 0;  //!< if positive: horizontal distance of the centres instead [m]
};

/** Reads the reference tracks. \param selection applies to a ground-truth folder, as in
 * readTruth(); in a file all boxes count \throws UserError for files that are missing or cannot be
 * read, or in which two boxes of a frame have the same id. */
[[nodiscard]] TrackData readReferenceTracks(const TrackSources& sources,
                                            TrackSelection& selection,
                                            const NoteSink& note);

/** Reads the estimated tracks; if the reference is a ground-truth folder, only those that the
 * selection covers. \throws UserError for files that are missing or cannot be read, in which two
 * boxes of a frame have the same id, or one has none; for a calibration and boxes without
 * rectangles in the image. */
[[nodiscard]] TrackData readEstimatedTracks(const TrackSources& sources,
                                            const TrackData& truth,
                                            const TrackSelection& selection);

/** Why figures without a calibration may be wrong, for the console: most boxes of a side are higher
 * above the lidar than what moves on the ground, as those of a camera are, whose z is ahead. Empty
 * if nothing is wrong, or with a calibration. */
[[nodiscard]] std::string boxFrameWarning(const TrackSources& sources,
                                          const TrackData& truth,
                                          const TrackData& estimate);

/** Whether Car, Van, Truck and Bus are one class: if the reference or the estimate is a folder. */
[[nodiscard]] bool typesAreMerged(const TrackSources& sources);

/** The true and estimated boxes over all frames that either covers, classes merged if
 * typesAreMerged(). */
[[nodiscard]] TrackSequence sequenceOf(const TrackSources& sources,
                                       const TrackData& truth,
                                       const TrackData& estimate);

/** Restricts the reference to the frames that the run processed, and at least to the last estimated
 * box. \return those frames; nothing if all are kept */
std::optional<FrameRange> keepProcessedFrames(const TrackSources& sources, TrackSequence& sequence);

/** The classes to evaluate, as the boxes name them; "" is all classes together. \param given
 * classes as named by the user; empty: the classes of the reference's counted boxes, and all
 * together for files in the lidar frame \throws UserError for an unknown class. */
[[nodiscard]] std::vector<std::string> trackClasses(const TrackSources& sources,
                                                    const TrackSequence& sequence,
                                                    const std::vector<std::string>& given);

struct TrackReport
{
  Table metrics;  //!< CLEAR-MOT, HOTA and AB3DMOT's averages of each class
  Table errors;   //!< errors of position, yaw and speed, by class and range
  std::string json;
};

/** \param types as trackClasses() */
[[nodiscard]] TrackReport evaluateTracks(const TrackSources& sources,
                                         const TrackMatching& matching,
                                         const TrackSequence& sequence,
                                         std::vector<std::string> types,
                                         const TrackSpeeds& true_speeds,
                                         const TrackSpeeds& estimated_speeds);
}  // namespace dyslam
