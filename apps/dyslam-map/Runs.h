// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/RunMerger.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/io/RawlogSource.h>

#include <string>
#include <vector>

#include "RunScans.h"

namespace dyslam
{
/** A run of dyslam: its folder and results. */
struct Run
{
  std::string folder;
  std::string name;    //!< last part of the folder; longer where two would have one name
  std::string rawlog;  //!< as report.json has it
  Trajectory trajectory;
  FactorGraph graph;
  std::vector<double> keyframe_stamps;
  Trajectory truth;  //!< in the world of the recording; empty where it has none
  RawlogSourceOptions source;
  RunScansOptions scans;
};

/** \param folders output folders of dyslam, each of which may be followed by `=` and its recording.
 * \throws UserError naming what is missing. */
[[nodiscard]] std::vector<Run> readRuns(const std::vector<std::string>& folders, double tolerance);

/** Finds the relative poses of the runs. Reads every recording once, and stores its ground truth.
 * \param threads 0: the machine's number \throws UserError for a recording that cannot be read. */
[[nodiscard]] RunMerge mergeRuns(std::vector<Run>& runs,
                                 const RunMergerConfig& config,
                                 int threads,
                                 bool quiet);

/** The run's trajectory with its keyframes at the merged poses; between two keyframes the change is
 * that of both, by time. \param merged T_map_vehicle of every keyframe */
[[nodiscard]] Trajectory mergedTrajectory(const Run& run, const std::vector<Pose>& merged);
}  // namespace dyslam
