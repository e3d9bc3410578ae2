// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/LabelFolders.h>
#include <dyslam/benchmarks/NoteSink.h>
#include <dyslam/eval/Consistency.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/train/DataSplits.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dyslam
{
/** Results of one run and its ground truth. */
struct RunScores
{
  std::string name;
  nlohmann::ordered_json report;
  std::optional<TrajectoryReport> trajectory;
  std::optional<TrajectoryReport> odometry;
  std::optional<OdometryConsistency> consistency;  //!< nothing unless the ground truth is exact
  PoseOrigin truth;                                //!< of the true poses
  std::optional<LabelComparison> labels;
  std::optional<SimulatedWorld> world;  //!< nothing if the recording is not known to be simulated
};

/** Why this is no output folder of a run; empty if it is one. */
[[nodiscard]] std::string whyNoRun(const std::string& folder);

/** \param truth folder of the ground truth; empty: the one beside the rawlog \param note called for
 * what is missing \throws UserError if it is no folder of a run. */
[[nodiscard]] RunScores scoresOf(const std::string& folder,
                                 const std::string& truth,
                                 const TrajectoryMetricsOptions& metrics,
                                 const NoteSink& note);

/** A number of a report; nothing if it is missing. */
[[nodiscard]] std::optional<double> number(const nlohmann::ordered_json& json, const char* key);

/** Nothing if it is not known which world was recorded, or its seed is in no split. */
[[nodiscard]] std::optional<Split> splitOf(const RunScores& scores, const DataSplits& splits);
}  // namespace dyslam
