// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/train/TrainDylo.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dyslam
{
/** Command line of either network: the request, and what its config is made of. */
struct TrainArguments : DyloTrainRequest
{
  std::string config;                    //!< ini file, or name of a shipped one
  std::vector<std::string> assignments;  //!< section.key=value

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
}  // namespace dyslam
