// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapbuilder/MapRun.h>

#include <optional>
#include <string>
#include <vector>

#include "../common/RangeFlags.h"

namespace dyslam
{
/** What the map is built of: a recording, or several runs. */
struct MapInputs
{
  RecordingOnTrajectory recording;
  std::string run;  //!< folder of a run, for parts of the recording that are not given
  std::vector<std::string> runs;  //!< folders of runs to be merged, instead of a recording
  RangeFlags range;               //!< scans of the recording that are used
};

/** Settings as the user gives them; loadConfig() reads them. */
struct GivenMapSettings
{
  std::string config;                       //!< ini; empty: that of the run or of the sensor
  std::vector<std::string> assignments;     //!< of --set
  std::optional<double> keyframe_distance;  //!< replaces that of the settings [m]
  bool full = false;                        //!< clouds hold every static point
};

/** Arguments of dyslam-map. */
struct Arguments
{
  MapInputs inputs;
  GivenMapSettings given;
  MapBuilderOptions builder;
  RunMergerConfig merger;  //!< of merged runs
  MapOutputs outputs;
  std::string map_pose;  //!< MapOutputs::T_fixed_map as poseFromOption() reads it
  bool force = false;    //!< replace files of a run
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a);
/** Checks endings, folders, flags and whether files of a run would be replaced, before the work
 * starts. \throws UserError. */
void checkOutputs(const Arguments& a);
}  // namespace dyslam
