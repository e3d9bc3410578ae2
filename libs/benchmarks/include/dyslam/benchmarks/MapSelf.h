// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/MapQuality.h>
#include <dyslam/eval/Table.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapbuilder/MapListener.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** A trajectory whose map is evaluated. */
struct MapSelfTrajectory
{
  std::string path;        //!< TUM or KITTI file
  bool of_lidar = false;   //!< the poses are those of the lidar, not of the vehicle
  double time_offset = 0;  //!< added to the time stamps of the poses (TUM) [s]
};

/** Arguments of `dyslam-eval map --self`. */
struct MapSelfArguments
{
  std::string rawlog;
  std::string config;  //!< ini with a section [preprocess]; empty: defaults
  std::vector<MapSelfTrajectory> trajectories;
  RawlogSourceOptions source;
  MapQualityOptions quality;
  std::size_t points = 20000;  //!< number of map points whose neighbourhoods are evaluated
  double tolerance = 0.01;     //!< tolerance of time stamps where a pose cannot be interpolated [s]
};

/** Sharpness of the map of one trajectory. */
struct MapSelfScores
{
  MapSharpness mean;
  std::size_t scans = 0;  //!< number of scans for which every trajectory has a pose
};

/** Scores of each trajectory, over the same scans and points. The recording is read twice: first
 * points are chosen, independently of the trajectories, then the map is streamed. \param listener
 * shows the progress of each reading, and is warned if many scans lack a pose or no point has a
 * value \throws UserError for files that cannot be used together. */
[[nodiscard]] std::vector<MapSelfScores> evaluateMapSelf(const MapSelfArguments& a,
                                                         MapListener& listener);

/** One row per trajectory. \param names of the trajectories */
[[nodiscard]] Table mapSelfTable(const std::vector<std::string>& names,
                                 const std::vector<MapSelfScores>& scores);
[[nodiscard]] std::string mapSelfJson(const MapSelfArguments& a,
                                      const std::vector<std::string>& names,
                                      const std::vector<MapSelfScores>& scores);
}  // namespace dyslam
