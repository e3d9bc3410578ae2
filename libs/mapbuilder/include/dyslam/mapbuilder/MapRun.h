// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapbuilder/MapBuilder.h>
#include <dyslam/mapbuilder/MapListener.h>
#include <dyslam/mapbuilder/MapOutputs.h>
#include <dyslam/mapbuilder/RunFolder.h>
#include <dyslam/mapbuilder/RunScans.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** A recording and the poses of its scans. */
struct RecordingOnTrajectory
{
  std::string rawlog;
  std::string trajectory;   //!< TUM or KITTI file
  bool of_lidar = false;    //!< poses of the lidar, not of the vehicle
  double time_offset = 0;   //!< added to the stamps of the poses (TUM) [s]
  bool unfinished = false;  //!< poses of a run that ended before its recording
  RawlogSourceOptions source;
  RunScansOptions scans;
};

/** Completes a recording from the output folder of a run: the recording that report.json names, the
 * trajectory, and labels and tracks if the folder has them. Given values are kept.
 * \throws UserError naming what is missing and its flag. */
void completeFromRun(const std::string& folder, RecordingOnTrajectory& recording);

/** Settings in effective.ini of a run. \throws UserError if its folder has none. */
[[nodiscard]] std::string settingsOfRun(const std::string& folder);

/** Summary of a map that was built and written. */
struct MapReport
{
  std::size_t scans = 0;
  std::size_t skipped = 0;       //!< number of scans without a pose
  std::size_t unregistered = 0;  //!< number of scans that the run could not register
  std::size_t keyframes = 0;
  std::size_t points = 0;  //!< number of points of the clouds, else of the map, else labelled ones
  double voxel_size = 0;   //!< side of the map's voxels [m]; 0: there is only the labelled map
  /** Files that could not be written, and what the others lack: scans after damage, runs; empty if
   * nothing. */
  std::string problem;
};

/** Summary of a map of several runs. */
struct MergeReport : MapReport
{
  std::size_t joined = 0;  //!< number of runs in the map
  std::string table;       //!< loops and errors between the runs, as text
  std::string references;  //!< satellite positions and verticals of the runs, as text; else empty
};

/** Builds the static map of a recording along a trajectory, and writes it, with
 * MapOutputs::T_fixed_map also the trajectory.
 *
 * If the recording turns out damaged halfway, the map has the scans before the damage. If a file
 * cannot be written, the others are: MapReport::problem.
 * \throws UserError for bad input. */
MapReport buildMap(const RecordingOnTrajectory& recording,
                   const MapBuilderOptions& options,
                   const MapOutputs& outputs,
                   MapListener& listener);

/** Merges runs of one place: writes one map of all that share places with those joined before, a
 * trajectory of each in the frame of the first, or of MapOutputs::T_fixed_map (TUM and KITTI) and a
 * table, all beside the first output. With satellite positions of a joined run the merged map has a
 * georeference and trajectories in UTM, too. Runs that share no place with the others are left out.
 * Moving points are those of the labels of a run; without them those with hindsight, whatever
 * HindsightOptions::hindsight is. \param runs from readRunFolders(), in order of time \throws
 * UserError as buildMap(), if MapOutputs::utm or RunMergerOptions::level_map asks for what no run
 * shows, and if no run could be joined to the first: nothing is written then. */
MergeReport mergeMaps(const std::vector<RunFolder>& runs,
                      const RunMergerConfig& merger,
                      const MapBuilderOptions& options,
                      const MapOutputs& outputs,
                      MapListener& listener);
}  // namespace dyslam
