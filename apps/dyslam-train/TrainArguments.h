// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Command line of either network. */
struct TrainArguments
{
  std::string config;  //!< ini file, or name of a shipped one
  std::string output;
  std::string start;  //!< weights: a file, or the name of shipped ones
  bool resume = false;
  bool validate_only = false;
  std::vector<std::string> assignments;  //!< section.key=value
  std::string device = "cpu";            //!< cpu or cuda
  std::string mask_folder;               //!< DyLO's

  /** \throws UserError for options that do not go together. */
  void requireConsistent() const;
  /** The config file with the assignments done. \param network dylo or dyseg \throws UserError. */
  [[nodiscard]] Config loadConfig(const std::string& network) const;
};

/** The subcommand of each network, filling `arguments`. */
CLI::App& declareDylo(CLI::App& app, TrainArguments& arguments);
CLI::App& declareDyseg(CLI::App& app, TrainArguments& arguments);

/** Whether the user has asked to stop (Ctrl-C or SIGTERM), from the first call on. */
[[nodiscard]] bool stopRequested();

void trainDyloCommand(const TrainArguments& arguments);   //!< \throws UserError
void trainDysegCommand(const TrainArguments& arguments);  //!< \throws UserError
}  // namespace dyslam
