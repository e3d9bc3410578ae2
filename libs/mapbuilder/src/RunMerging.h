// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/mapbuilder/MapListener.h>
#include <dyslam/mapbuilder/RunFolder.h>
#include <dyslam/mapping/StaticMap.h>

#include <vector>

namespace dyslam
{
struct MergedRuns
{
  RunMerge merge;
  /** Ground truth by run, in the world frame of its recording; empty without. */
  std::vector<Trajectory> truth;
};

/** Finds the relative poses of the runs. Reads every recording once.
 * \param map the points that it leaves out are not registered \param threads 0: the machine's
 * number \throws UserError for a recording that cannot be read. */
[[nodiscard]] MergedRuns mergeRuns(const std::vector<RunFolder>& runs,
                                   const RunMergerConfig& config,
                                   const StaticMapOptions& map,
                                   int threads,
                                   MapListener& listener);

/** The run's trajectory with its keyframes at the merged poses; between two keyframes the change is
 * that of both, by time.
 * \param merged T_map_vehicle of every keyframe \return as long as RunFolder::trajectory */
[[nodiscard]] Trajectory mergedTrajectory(const RunFolder& run, const std::vector<Pose>& merged);
}  // namespace dyslam
