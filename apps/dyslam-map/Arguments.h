// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapbuilder/MapRun.h>

#include <optional>
#include <string>
#include <vector>

#include "../common/RangeFlags.h"

namespace dyslam
{
/** Arguments of dyslam-map. */
struct Arguments
{
  RecordingOnTrajectory recording;
  std::string run;  //!< folder of a run, for parts of the recording that are not given
  std::vector<std::string> runs;  //!< folders of runs to be merged, instead of a recording
  std::string map_pose;           //!< MapOutputs::T_fixed_map as poseFromOption() reads it
  std::string config;
  std::vector<std::string> assignments;
  MapBuilderOptions builder;
  RunMergerConfig merger;
  MapOutputs outputs;
  RangeFlags range;
  std::optional<double> keyframe_distance;
  bool full = false;
  bool force = false;  //!< replace files of a run
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a);
/** Checks endings, folders, flags and whether files of a run would be replaced, before the work
 * starts. \throws UserError. */
void checkOutputs(const Arguments& a);
}  // namespace dyslam
