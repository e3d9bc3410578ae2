// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <functional>

#include "RunHistory.h"
#include "RunResults.h"

namespace dyslam
{
/** An object at a scan at which it counts (TrackLife); smoothed if a smoothed state exists, else by
 * the tracker. */
struct ReportedObject
{
  /** State in the odometry frame; `dynamic` by the tracker, the second one if there is one. */
  TrackedObject object;
  const PastScan& scan;     //!< entry of RunHistory::scans()
  std::size_t scan_number;  //!< index in RunHistory::scans() and RunResults::trajectory
  Pose T_map_odom;          //!< at this scan, by the final trajectory (includes loops)
};

/** Calls `use` for every object at every scan at which it counts, ordered by scan. */
void forEachReported(const RunResults& results,
                     const std::function<void(const ReportedObject&)>& use);

struct TrackCounts
{
  std::size_t reported = 0;  //!< number of tracks at which forEachReported() arrives
  std::size_t moving = 0;    //!< number of those that move at some time
};

[[nodiscard]] TrackCounts countTracks(const RunResults& results);
}  // namespace dyslam
