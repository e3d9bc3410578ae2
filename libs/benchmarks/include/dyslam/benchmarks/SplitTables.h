// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/RunScores.h>
#include <dyslam/eval/Table.h>

#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** A column of a table: its heading, and the folder (METHOD) of its runs. */
struct RunColumn
{
  std::string heading;
  std::string folder;
};

/** Folders whose runs the tables of a split show. */
struct SplitColumns
{
  std::string whole;                //!< folder of the runs of the whole pipeline
  std::vector<RunColumn> odometry;  //!< columns of driftTable() and timeTable()
  std::vector<RunColumn> labels;    //!< columns of movingTable()
};

/** The runs of one drive by folder. */
struct DriveScores
{
  std::string name;
  std::map<std::string, RunScores> runs;
};

/** What readDrives() found. */
struct SplitRuns
{
  std::vector<DriveScores> drives;
  std::vector<std::string> failed;  //!< folders of runs that cannot be read
};

/** Reads the drives in a folder that has a run in each DRIVE/METHOD: every DRIVE with runs of the
 * columns. Runs that cannot be read are left out. \param note as scoresOf(); also called for each
 * run that is left out \throws UserError if no run can be read. */
[[nodiscard]] SplitRuns readDrives(const std::string& runs,
                                   const SplitColumns& columns,
                                   const TrajectoryMetricsOptions& metrics,
                                   const NoteSink& note);

// Means are over the drives for which all shown columns have a figure, and state their number;
// columns without any run are left out. The best figure of a row is bold.

/** t_rel and r_rel of the odometry, in the form of the paper's Table 1. */
[[nodiscard]] Table driftTable(const std::vector<DriveScores>& drives,
                               const std::vector<RunColumn>& columns);
/** Means of the paper's Table 1, a row for each shown column of a method that it has: of other data
 * than those of driftTable(). */
[[nodiscard]] Table paperDriftTable(const std::vector<DriveScores>& drives,
                                    const std::vector<RunColumn>& columns);
/** IoU, precision and recall of the moving points, for drives with moving points. The last row is
 * of all points together, of the drives for which all shown columns have labels. */
[[nodiscard]] Table movingTable(const std::vector<DriveScores>& drives,
                                const std::vector<RunColumn>& columns);
/** Absolute errors of the odometry and of the final trajectory. */
[[nodiscard]] Table absoluteTable(const std::vector<DriveScores>& drives,
                                  const std::string& folder);
/** Mean time per scan, in the form of the paper's Table 3, whose rows are appended. */
[[nodiscard]] Table timeTable(const std::vector<DriveScores>& drives,
                              const std::vector<RunColumn>& columns);

/** Properties of each drive: world, sensor, traffic, seed, scans and length. \param folder folder
 * (METHOD) of the runs that they are read from */
[[nodiscard]] Table drivesTable(const std::vector<DriveScores>& drives, const std::string& folder);

/** All tables of a split with their headings, in Markdown. \param segment_lengths lengths of the
 * segments of t_rel and r_rel [m] \throws UserError if splits.ini cannot be read. */
[[nodiscard]] std::string splitMarkdown(const std::vector<DriveScores>& drives,
                                        const SplitColumns& columns,
                                        const std::vector<double>& segment_lengths);
}  // namespace dyslam
