// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/SmoothedObject.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/tracking/TrackSmoother.h>

#include <map>
#include <vector>

#include "RunHistory.h"

namespace dyslam
{
/** Reported objects of a run, smoothed at its end. */
struct SmoothedTracks
{
  std::vector<SmoothedObject> objects;  //!< ordered by scan, then id; without covariances
  std::map<int, int> merged;            //!< id of the object of each merged track
};

/** Merges the tracks of each object (findMergedTracks()), and determines class, size, position and
 * velocity of the reported objects of a run from earlier and later scans, in the map frame of
 * `trajectory`. The heading of driving vehicles is their direction of motion. Before the tracker
 * decided that an object moves, its speed decides.
 *
 * \param trajectory T_map_vehicle of the scans of `history`
 * \param complete_boxes the boxes are those of visible parts of objects, to be completed
 * \return nothing if smoothing is off. */
[[nodiscard]] SmoothedTracks smoothTracks(const RunHistory& history,
                                          const Trajectory& trajectory,
                                          const TrackSmoothingOptions& options,
                                          bool complete_boxes);
}  // namespace dyslam
