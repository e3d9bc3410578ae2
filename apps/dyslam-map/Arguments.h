// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapbuilder/MapRun.h>

#include <optional>
#include <string>
#include <vector>

namespace CLI
{
class App;
}

namespace dyslam
{
/** Arguments of dyslam-map. */
struct Arguments
{
  RecordingOnTrajectory recording;
  std::string run;                //!< folder of a run that has what is not given of the recording
  std::vector<std::string> runs;  //!< to be merged, instead of a recording
  std::string config;
  std::vector<std::string> assignments;
  MapBuilderOptions builder;
  RunMergerConfig merger;
  MapOutputs outputs;
  std::optional<int> skip_first_n;
  std::optional<int> only_first_n;
  std::optional<double> start;
  std::optional<double> end;
  std::optional<double> keyframe_distance;
  bool full = false;
  bool force = false;  //!< replace files of a run
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a);
/** Reads our sections of the ini; an ini of a whole run may hold others. Without an ini it is
 * `effective.ini` of the run, or beside the trajectory, if there is one, or of the first merged
 * run. \throws UserError. */
void loadConfig(Arguments& a);
/** Finds bad endings, folders, flags and files of a run that would be replaced before the work
 * starts. \throws UserError. */
void checkOutputs(const Arguments& a);
}  // namespace dyslam
