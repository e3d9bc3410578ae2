// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/eval/Table.h>

#include <string>
#include <vector>

#include "MapBuilder.h"
#include "Runs.h"

namespace dyslam
{
/** A row for each two joined runs that share places: loops, those left out, their residual, and,
 * where both have ground truth in one frame, the error between the runs at places that both
 * visited.
 * \param merged trajectories by run, empty where a run was not joined */
[[nodiscard]] Table mergeTable(const std::vector<Run>& runs,
                               const RunMerge& merge,
                               const std::vector<Trajectory>& merged);

/** Picture of the runs' own maps, each in its own frame, beside the merged one. \throws UserError.
 */
void writeRunComparison(const std::vector<Run>& runs,
                        const RunMerge& merge,
                        const MapBuilder& builder,
                        const std::string& path);

/** "`b`, `c`"; empty if all are joined. */
[[nodiscard]] std::string namesOfUnjoined(const std::vector<Run>& runs, const RunMerge& merge);
}  // namespace dyslam
