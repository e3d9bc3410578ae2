// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/io/RawlogSource.h>

#include <optional>
#include <string>
#include <vector>

#include "MapBuilder.h"

namespace CLI
{
class App;
}

namespace dyslam
{
/** Arguments of dyslam-map. */
struct Arguments
{
  std::string rawlog;
  std::string trajectory;
  std::vector<std::string> runs;  //!< to be merged; then there is no rawlog and no trajectory
  std::string config;
  std::vector<std::string> assignments;
  std::vector<std::string> outputs;
  MapBuilderOptions builder;
  RunScansOptions scans;
  RunMergerConfig merger;
  RawlogSourceOptions source;
  MapExportOptions exports;
  std::string labelled_map;
  std::string picture;
  std::string compare;
  bool of_lidar = false;  //!< the poses are the lidar's, not the vehicle's
  std::optional<int> skip_first_n;
  std::optional<int> only_first_n;
  bool full = false;
  bool force = false;     //!< replace files of a run
  std::string effective;  //!< all settings in effect, as an ini
  std::optional<double> keyframe_distance;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a);
/** Reads our sections of the ini; an ini of a whole run may hold others. Without an ini it is
 * `effective.ini` beside the trajectory, if there is one, or of the first merged run.
 * \throws UserError. */
void loadConfig(Arguments& a);
/** `map.las` and `_tum.txt` become `map_tum.txt`: beside the first output; empty without any. */
[[nodiscard]] std::string besideOutput(const Arguments& a, const std::string& ending);
/** File that the settings are written to; empty without any output. */
[[nodiscard]] std::string effectiveIniOf(const Arguments& a);
/** Whether some output needs the map in memory as a whole: all but clouds in tiles. */
[[nodiscard]] bool needsWholeMap(const Arguments& a);
/** Whether some output needs the scans again after the map is built. */
[[nodiscard]] bool needsScans(const Arguments& a);
/** Finds bad endings, folders, flags and files of a run that would be replaced before the work
 * starts. \throws UserError. */
void checkOutputs(const Arguments& a);
}  // namespace dyslam
