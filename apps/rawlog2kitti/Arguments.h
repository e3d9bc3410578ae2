// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/KittiExport.h>

#include <string>
#include <vector>

namespace CLI
{
class App;
}

namespace dyslam
{
/** Arguments of rawlog2kitti. */
struct Arguments
{
  std::string input;
  std::string run;  //!< output folder of dyslam; empty: none
  std::string output;
  KittiExportOptions options;
  bool quiet = false;
  std::vector<std::string> missing;  //!< notes on what the run does not have
};

void declare(CLI::App& app, Arguments& arguments);

/** Completes what was not given from the output folder of a run: rawlog, trajectory, range and
 * lidars, and the calibration of the KITTI recording that the rawlog was converted from.
 * \throws UserError naming what is missing and its flag. */
void completeFrom(const std::string& run, Arguments& arguments);
}  // namespace dyslam
