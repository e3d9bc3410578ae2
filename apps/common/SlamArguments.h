// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/TwoPassRun.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "RangeFlags.h"

namespace dyslam
{
/** Flags of the programs that run the pipeline on a rawlog; `assignments` are those of --set. */
struct SlamArguments : RunRequest
{
  std::string verbosity = "INFO";
  RangeFlags range;
  std::string prior_map;    //!< map file or output folder of a run; empty: none
  std::string prior_start;  //!< pose at the first scan in the prior map; empty: searched for
  /** Of a recording that goes on: how far the run is behind it, for the line of progress; empty
   * once it has ended. Null: it has ended before. */
  std::function<std::string()> lag;

  [[nodiscard]] bool quiet() const { return verbosity == "ERROR"; }
};

/** Declares all flags except those of input and output. */
void declareSlamArguments(CLI::App& app, SlamArguments& a);

/** Settings of the command line: those of --set, then those with flags of their own. */
std::vector<std::string> assignmentsOf(const SlamArguments& a);

/** \throws UserError if no recording is given. */
void requireGiven(const std::string& rawlog);
}  // namespace dyslam
