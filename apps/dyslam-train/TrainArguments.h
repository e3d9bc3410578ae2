// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Config.h>

#include <string>
#include <vector>

namespace dyslam
{
/** What a command line asks for, of either network. */
struct TrainArguments
{
  std::string config;  //!< a file, or the name of one that comes with DySLAM
  std::string output;
  std::string start;
  std::string blend;
  double blend_share = 0;
  bool resume = false;
  bool validate_only = false;
  std::vector<std::string> assignments;  //!< section.key=value
  std::string device = "cpu";            //!< DyLO's
  std::string mask_folder;               //!< DyLO's

  /** The config file with the assignments done. \throws UserError. */
  [[nodiscard]] Config loadConfig() const;
};

/** \param network dylo or dyseg, for the messages \param words what follows it on the command line.
 * \throws UserError for what is no option of that network, or does not go together. */
[[nodiscard]] TrainArguments parseTrainArguments(const std::string& network,
                                                 const std::vector<std::string>& words);

/** Whether the user has asked to stop (Ctrl-C or SIGTERM), from the first call on. */
[[nodiscard]] bool stopRequested();

void trainDyloCommand(const TrainArguments& arguments);   //!< \throws UserError
void trainDysegCommand(const TrainArguments& arguments);  //!< \throws UserError
}  // namespace dyslam
