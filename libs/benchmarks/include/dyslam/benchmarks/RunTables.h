// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/RunScores.h>
#include <dyslam/eval/Table.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Two rows per run: the final trajectory, with labels and times, and the odometry; one row if
 * these are the same. With two or more runs, all with ground truth and of different recordings,
 * also the means; their scans and lengths are sums. */
[[nodiscard]] Table runTable(const std::vector<RunScores>& runs);
/** Mean time of each stage, one column per run; without rows if no run states times. */
[[nodiscard]] Table stageTable(const std::vector<RunScores>& runs);
/** The odometry consistencies of the runs that have one, with the names of the runs. */
[[nodiscard]] std::vector<OdometryConsistency> consistenciesOf(const std::vector<RunScores>& runs);
// Of the lines about runs those of equal text are one, with the names of its runs.

/** The split of each run's recording, where that is known. \throws UserError if
 * splits.ini cannot be read. */
[[nodiscard]] std::string splitLines(const std::vector<RunScores>& runs);
/** Where the ground truth of each run is from, and what this means for its figures; two lines for
 * GNSS/INS. */
[[nodiscard]] std::string truthLines(const std::vector<RunScores>& runs);
/** Of each run with labels: whether they were decided with hindsight, and, if less than 95 % of the
 * points are labelled in the ground truth, how many are. */
[[nodiscard]] std::string labelLines(const std::vector<RunScores>& runs);
/** What the reports of the runs warn of: why a run is unusable, and its warnings. */
[[nodiscard]] std::string warningLines(const std::vector<RunScores>& runs);
/** All results as JSON, one object per run. \throws UserError as splitLines(). */
[[nodiscard]] std::string runJson(const std::vector<RunScores>& runs);
}  // namespace dyslam
