// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/LabelFolders.h>
#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/eval/Consistency.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/RunReport.h>
#include <dyslam/train/DataSplits.h>

#include <optional>
#include <string>

namespace dyslam
{
/** Results of one run and its ground truth. */
struct RunScores
{
  std::string name;
  RunReport report;                //!< empty if the run did not write one
  std::string report_text = "{}";  //!< JSON of the report as in its file, for the results' JSON
  std::optional<TrajectoryReport> trajectory;
  std::optional<TrajectoryReport> odometry;
  std::optional<OdometryConsistency> consistency;  //!< nothing unless the ground truth is exact
  PoseOrigin truth;                                //!< origin of the true poses
  Trajectory true_poses;                           //!< those that `trajectory` was compared with
  std::optional<LabelComparison> labels;
  /** Whether the labels were decided with earlier and later scans; nothing if effective.ini is
   * missing, or does not state it. */
  std::optional<bool> labels_with_hindsight;
  std::optional<SimulatedWorld> world;  //!< nothing if the recording is not known to be simulated

  /** Whether there is no other trajectory than the odometry: the graph has changed nothing, as
   * without loops. */
  [[nodiscard]] bool odometryIsFinal() const;
};

/** Why a folder is no output folder of a run; empty if it is one. */
[[nodiscard]] std::string whyNoRun(const std::string& folder);

/** Evaluates a run. \param folder output folder of the run \param truth folder of the ground truth;
 * empty: the folder beside the rawlog \param note called for missing data \param interpolate the
 * true poses are interpolated at the stamps of the run, between poses at most this far from them
 * [s]; nothing: those with the same stamps \throws UserError if `folder` is no folder of a run. */
[[nodiscard]] RunScores scoresOf(const std::string& folder,
                                 const std::string& truth,
                                 const TrajectoryMetricsOptions& metrics,
                                 const NoteSink& note,
                                 const std::optional<double>& interpolate = {});

/** The split of the recorded world; nothing if the world is not known or its seed is in no split.
 */
[[nodiscard]] std::optional<Split> splitOf(const RunScores& scores, const DataSplits& splits);
}  // namespace dyslam
