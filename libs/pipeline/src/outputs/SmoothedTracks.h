// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "../RunHistory.h"
#include "../RunOutput.h"

namespace dyslam
{
/** The tracked object with position, heading, velocity and covariance of the smoothed one, odometry
 * frame.
 * \param T_odom_map at that scan */
[[nodiscard]] TrackedObject smoothedTrack(const TrackedObject& tracked,
                                          const SmoothedObject& smoothed,
                                          const Pose& T_odom_map);

/** An object at a scan at which it counts (TrackLife), smoothed where there is more than the
 * tracker's state. */
struct ReportedState
{
  /** Odometry frame; `dynamic` as the tracker decided, with hindsight if it is tracked so. */
  TrackedObject object;
  const PastScan& scan;     //!< of RunHistory::scans()
  std::size_t scan_number;  //!< in there, and in RunResults::trajectory
  Pose T_map_odom;          //!< by the final trajectory: loops have moved the odometry frame
};

/** Calls `use` for every object at every scan at which it counts, by scan. */
void forEachReported(const RunResults& results,
                     const std::function<void(const ReportedState&)>& use);

/** Number of tracks that move at some time. */
[[nodiscard]] std::size_t movingTracks(const RunResults& results);
}  // namespace dyslam
