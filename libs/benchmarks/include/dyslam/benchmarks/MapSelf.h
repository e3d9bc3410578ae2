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
/** What is evaluated, and how (`dyslam-eval map --self`). */
struct MapSelfArguments
{
  std::string rawlog;
  std::string config;                     //!< ini with a section [preprocess]; empty: defaults
  std::vector<std::string> trajectories;  //!< TUM or KITTI files
  RawlogSourceOptions source;
  MapQualityOptions quality;
  std::size_t points = 20000;  //!< of the map, whose neighbourhoods are evaluated
  double tolerance = 0.01;     //!< of time stamps where a pose cannot be interpolated [s]
  bool of_lidar = false;       //!< the poses are the lidar's, not the vehicle's
};

/** Sharpness of the map of one trajectory. */
struct MapSelfScores
{
  MapSharpness mean;
  std::size_t scans = 0;  //!< for which every trajectory has a pose
};

/** One per trajectory, over the same scans and points. The recording is read twice: points are
 * chosen, then the map is streamed. The choice does not depend on the trajectories.
 * \param listener shows the progress of each reading \throws UserError for files that cannot be
 * used together. */
[[nodiscard]] std::vector<MapSelfScores> evaluateMapSelf(const MapSelfArguments& a,
                                                         MapListener& listener);

/** One row per trajectory. \param names of the trajectories */
[[nodiscard]] Table mapSelfTable(const std::vector<std::string>& names,
                                 const std::vector<MapSelfScores>& scores);
[[nodiscard]] std::string mapSelfJson(const MapSelfArguments& a,
                                      const std::vector<std::string>& names,
                                      const std::vector<MapSelfScores>& scores);
}  // namespace dyslam
