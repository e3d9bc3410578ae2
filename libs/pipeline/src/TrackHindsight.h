// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/tracking/TrackSmoother.h>

#include <map>
#include <vector>

#include "RunHistory.h"

namespace dyslam
{
/** The reported objects of a run with hindsight. */
struct TracksInHindsight
{
  std::vector<SmoothedObject> objects;  //!< by scan, then id; without covariances
  std::map<int, int> merged;            //!< id of the object of each merged track
};

/** Merges the tracks of an object (findMergedTracks()), and determines class, size, position and
 * velocity of the reported objects of a run from earlier and later scans, in the map frame of
 * `trajectory`. Vehicles head where they drive; before the tracker decides that an object moves,
 * its speed does.
 *
 * \param trajectory poses of the scans of `history`
 * \param complete_boxes boxes are those of the visible parts of objects
 * \return nothing if smoothing is off. */
[[nodiscard]] TracksInHindsight smoothReported(const RunHistory& history,
                                               const Trajectory& trajectory,
                                               const TrackSmoothingOptions& options,
                                               bool complete_boxes);
}  // namespace dyslam
