// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Recorder.h"

namespace CLI
{
class App;
}

namespace dyslam::sim
{
/** Arguments of dyslam-sim. */
struct Arguments
{
  Recording recording;
  std::string world = "urban";
  std::string sensor = "HDL64E";
  std::string ego = "automatic";
  std::vector<double> mounting_deg;  //!< roll and pitch of the first lidar; empty: upright
  std::vector<std::pair<std::string, std::string>> further_sensors;  //!< sensors and mountings
  std::string benchmark;  //!< folder for the benchmark set; empty: a recording or a series
  std::string split;      //!< data split whose drives are the set; empty: the standing set
  std::string only;       //!< name of the only recording of the set to make; empty: all
  std::string shard;
  int count = 0;  //!< number of recordings of a series; 0: a single one
  std::optional<double> seconds;
  bool no_noise = false;
  bool no_distortion = false;
  bool no_stops = false;
  bool no_flow = false;
  bool force = false;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a);

/** The recording of the arguments, without those of a set. \throws UserError for a bad one. */
[[nodiscard]] Recording recordingOf(const Arguments& a);
}  // namespace dyslam::sim
