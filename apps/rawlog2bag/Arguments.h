// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/BagExport.h>
#include <dyslam/io/ScanRange.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dyslam
{
/** Values of the flags of rawlog2bag. */
struct Arguments
{
  std::string input;
  std::string run;
  std::string output;
  std::string sensor_label;
  std::string further_lidars;
  ScanRange range;
  BagExportOptions options;
  bool no_map = false;
  bool quiet = false;
  std::vector<std::string> missing;  //!< what the run does not give, for the user
};

void declare(CLI::App& app, Arguments& arguments);
/** Completes what is not given from the folder of a run. \throws UserError. */
void completeFrom(const std::string& run, Arguments& arguments);
}  // namespace dyslam
