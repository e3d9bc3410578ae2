// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/RunScores.h>
#include <dyslam/eval/Table.h>

#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** A column of a table: its heading, and the folder of its runs. */
struct RunColumn
{
  std::string heading;
  std::string folder;
};

/** What the tables of a split show. */
struct SplitColumns
{
  std::string whole;                //!< folder of the runs of the whole pipeline
  std::vector<RunColumn> odometry;  //!< of driftTable() and timeTable()
  std::vector<RunColumn> labels;    //!< of movingTable()
};

/** The runs of one drive by folder. */
struct DriveScores
{
  std::string name;
  std::map<std::string, RunScores> runs;
};

/** The drives in a folder that has a run in each DRIVE/METHOD: every folder with runs of the
 * columns is one. \param note as scoresOf() \throws UserError if there is none. */
[[nodiscard]] std::vector<DriveScores> readDrives(const std::string& runs,
                                                  const SplitColumns& columns,
                                                  const TrajectoryMetricsOptions& metrics,
                                                  const NoteSink& note);

// Means are over those drives for which no shown column lacks its figure, and say how many these
// are; columns without any run are left out. The best of a row is bold.

/** t_rel and r_rel of the odometry, in the form of the paper's Table 1; the means of its rows
 * are the last row. */
[[nodiscard]] Table driftTable(const std::vector<DriveScores>& drives,
                               const std::vector<RunColumn>& columns);
/** IoU, precision and recall of the moving points, of drives that have any. */
[[nodiscard]] Table movingTable(const std::vector<DriveScores>& drives,
                                const std::vector<RunColumn>& columns);
/** Absolute errors of the odometry and of the final trajectory. */
[[nodiscard]] Table absoluteTable(const std::vector<DriveScores>& drives,
                                  const std::string& folder);
/** Time per scan, the mean over all scans, in the form of the paper's Table 3, whose rows are the
 * last. */
[[nodiscard]] Table timeTable(const std::vector<DriveScores>& drives,
                              const std::vector<RunColumn>& columns);

/** Properties of each drive: world, sensor, traffic, seed, scans and length. \param folder of the
 * runs that it is read from */
[[nodiscard]] Table drivesTable(const std::vector<DriveScores>& drives, const std::string& folder);

/** All these tables with their headings, in Markdown. \param segment_lengths of t_rel and r_rel [m]
 * \throws UserError if splits.ini cannot be read. */
[[nodiscard]] std::string splitMarkdown(const std::vector<DriveScores>& drives,
                                        const SplitColumns& columns,
                                        const std::vector<double>& segment_lengths);
}  // namespace dyslam
