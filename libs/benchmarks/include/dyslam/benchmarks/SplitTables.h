// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/RunScores.h>
#include <dyslam/eval/Table.h>

#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** A column of a table: its heading, and the folder of its runs: METHOD, or its path. */
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

/** Reads the drives in a folder that has a run in each DRIVE/METHOD, or in each METHOD/DRIVE as
 * folders of dyslam-batch: every DRIVE with runs of the columns. Runs that cannot be read are left
 * out. \param runs the folder; empty: the columns have the paths of METHOD folders \param note as
 * scoresOf(); also called for each run that is left out \throws UserError if no run can be read. */
[[nodiscard]] SplitRuns readDrives(const std::string& runs,
                                   const SplitColumns& columns,
                                   const TrajectoryMetricsOptions& metrics,
                                   const NoteSink& note);

/** Whether each drive with ground truth is a sequence of KITTI odometry (00 to 10), by its name and
 * the number of its scans. */
[[nodiscard]] bool areKittiOdometry(const std::vector<DriveScores>& drives);

// Means are over the drives for which all shown columns have a figure, and state their number;
// columns without any run or any figure are not shown. The best figure of a row is bold.

/** t_rel and r_rel of the odometry, in the form of the paper's Table 1, whose figures of LOAM and
 * DyLO are added if areKittiOdometry(). */
[[nodiscard]] Table driftTable(const std::vector<DriveScores>& drives,
                               const std::vector<RunColumn>& columns);
/** Headings of the columns that have runs, but no figure in driftTable(): without true poses, or
 * shorter than the segments. */
[[nodiscard]] std::vector<std::string> columnsWithoutDrift(const std::vector<DriveScores>& drives,
                                                           const std::vector<RunColumn>& columns);
/** As driftTable(), of the final trajectory: columns of runs whose trajectory the graph changed;
 * without rows if there are none. */
[[nodiscard]] Table finalDriftTable(const std::vector<DriveScores>& drives,
                                    const std::vector<RunColumn>& columns);
/** Means of the paper's Table 1, a row for each shown column of a method that it has: of other data
 * than those of driftTable(). */
[[nodiscard]] Table paperDriftTable(const std::vector<DriveScores>& drives,
                                    const std::vector<RunColumn>& columns);
/** IoU, precision and recall of the moving points, for drives with moving points; columns without
 * labels are left out. The last row is of all points together, of the drives for which all shown
 * columns have labels. Without rows if no run has labels. */
[[nodiscard]] Table movingTable(const std::vector<DriveScores>& drives,
                                const std::vector<RunColumn>& columns);
/** Absolute errors of the odometry and of the final trajectory. */
[[nodiscard]] Table absoluteTable(const std::vector<DriveScores>& drives,
                                  const std::string& folder);
/** Mean time per scan, in the form of the paper's Table 3. */
[[nodiscard]] Table timeTable(const std::vector<DriveScores>& drives,
                              const std::vector<RunColumn>& columns);
/** Appends the rows of the paper's Table 3 to timeTable(): of other data and another machine. */
void addPaperTimes(Table& times);

/** Properties of each drive: world, sensor, traffic, seed, scans and length. \param folder folder
 * (METHOD) of the runs that they are read from */
[[nodiscard]] Table drivesTable(const std::vector<DriveScores>& drives, const std::string& folder);

/** All tables with their headings, in Markdown, without those that have nothing to show; figures of
 * the paper that are of other data only if a drive is of a split. \param segment_lengths lengths of
 * the segments of t_rel and r_rel [m] \throws UserError if splits.ini cannot be read. */
[[nodiscard]] std::string splitMarkdown(const std::vector<DriveScores>& drives,
                                        const SplitColumns& columns,
                                        const std::vector<double>& segment_lengths);
}  // namespace dyslam
