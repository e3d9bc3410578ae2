// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/tracking/TrackSmoother.h>

#include <vector>

#include "RunHistory.h"

namespace dyslam
{
/** The reported objects of a run with class, size, position and velocity from earlier and later
 * scans, in the map frame of `trajectory`, by scan, then id; without covariances. Vehicles head
 * where they drive; before the tracker decides that an object moves, its speed does.
 *
 * \param trajectory poses of the scans of `history`
 * \param complete_boxes boxes are those of the visible parts of objects
 * \return none if smoothing is off. */
[[nodiscard]] std::vector<SmoothedObject> smoothReported(const RunHistory& history,
                                                         const Trajectory& trajectory,
                                                         const TrackSmoothingOptions& options,
                                                         bool complete_boxes);
}  // namespace dyslam
