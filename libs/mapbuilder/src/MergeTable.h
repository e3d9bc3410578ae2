// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Table.h>
#include <dyslam/mapbuilder/RunFolder.h>

#include <vector>

#include "RunMerging.h"

namespace dyslam
{
/** A row for each two joined runs that share places: loops, those left out, their residual, and,
 * where both have ground truth in one frame, the error between the runs at places that both
 * visited.
 * \param merged trajectories by run, empty where a run was not joined */
[[nodiscard]] Table mergeTable(const std::vector<RunFolder>& runs,
                               const MergedRuns& joined,
                               const std::vector<Trajectory>& merged);

/** A row for each joined run with satellite positions or a vertical: their number, their distance
 * from the merged poses, and the angle between the verticals of run and merged map. */
[[nodiscard]] Table referenceTable(const std::vector<RunFolder>& runs, const RunMerge& merge);
}  // namespace dyslam
