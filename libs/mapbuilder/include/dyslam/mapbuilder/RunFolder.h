// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/RunMerger.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapbuilder/RunScans.h>

#include <string>
#include <vector>

namespace dyslam
{
/** A run of dyslam, read from its output folder. */
struct RunFolder
{
  std::string folder;
  std::string name;       //!< last part of the folder; longer if two would be equal
  std::string rawlog;     //!< recording by report.json, unless another one was given
  Trajectory trajectory;  //!< T_map_vehicle of every scan, levelled vehicle frame
  FactorGraph graph;
  RunReferences references;             //!< from georeference.ini and report.json
  std::vector<double> keyframe_stamps;  //!< UNIX time [s], one per ego pose of the graph
  RawlogSourceOptions source;
  RunScansOptions scans;
};

/** A run as the user names it: its output folder, which may be followed by `=` and its recording.
 */
struct RunArgument
{
  explicit RunArgument(const std::string& argument);

  std::string folder;
  std::string rawlog;  //!< recording; empty: the one in report.json of the run
};

/** \param folders output folders of dyslam, each of which may be followed by `=` and its recording;
 * at least two \param tolerance of time stamps of scans and poses [s]
 * \throws UserError naming what is missing. */
[[nodiscard]] std::vector<RunFolder> readRunFolders(const std::vector<std::string>& folders,
                                                    double tolerance);
}  // namespace dyslam
