// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "RunHistory.h"
#include "RunResults.h"

namespace dyslam
{
/** The tracked object with position, heading, velocity and covariance of the smoothed object,
 * odometry frame.
 * \param T_odom_map transform at the object's scan */
[[nodiscard]] TrackedObject smoothedTrack(const TrackedObject& tracked,
                                          const SmoothedObject& smoothed,
                                          const Pose& T_odom_map);

/** An object at a scan at which it counts (TrackLife); smoothed if a smoothed state exists, else by
 * the tracker. */
struct ReportedState
{
  /** State in the odometry frame; `dynamic` by the tracker, with hindsight if tracked again. */
  TrackedObject object;
  const PastScan& scan;     //!< entry of RunHistory::scans()
  std::size_t scan_number;  //!< index in RunHistory::scans() and RunResults::trajectory
  Pose T_map_odom;          //!< at this scan, by the final trajectory (includes loops)
};

/** Calls `use` for every object at every scan at which it counts, ordered by scan. */
void forEachReported(const RunResults& results,
                     const std::function<void(const ReportedState&)>& use);

/** Number of tracks that move at some time. */
[[nodiscard]] std::size_t movingTracks(const RunResults& results);
}  // namespace dyslam
