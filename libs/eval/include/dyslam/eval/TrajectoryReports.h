// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Table with a row per estimate: t_rel, r_rel, RPE, ATE, forward ratio, end error. */
[[nodiscard]] Table trajectoryTable(const std::vector<TrajectoryReport>& reports);

/** trajectoryTable() with additional rows of the paper's results for a sequence.
 * \param paper_sequence "odometry/04" (Tables 1, 2), "tracking/04" (Table 6), "campus/01"
 * (Table 7). \throws UserError for a sequence not in the paper. */
[[nodiscard]] Table trajectoryTable(const std::vector<TrajectoryReport>& reports,
                                    const std::string& paper_sequence);

/** Table of max, mean, median, min, RMSE, std of relative and absolute errors, as in the paper's
 * Tables 2 and 7: one row per estimate and error. */
[[nodiscard]] Table errorStatisticsTable(const std::vector<TrajectoryReport>& reports);

/** Table of the drift by segment length: one row per length, two columns per estimate. */
[[nodiscard]] Table driftTable(const std::vector<TrajectoryReport>& reports);

/** All results as JSON, one object per estimate, keys in a fixed order. */
[[nodiscard]] std::string trajectoryJson(const std::vector<TrajectoryReport>& reports);
}  // namespace dyslam
