// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Config.h>

#include <functional>
#include <string>

namespace dyslam
{
struct DyloTrainRequest
{
  std::string output;   //!< folder for checkpoint.safetensors, dylo.safetensors, log.csv,
                        //!< validation.csv, effective.ini
  bool resume = false;  //!< continue from checkpoint.safetensors there
  std::string start;    //!< a checkpoint.safetensors or dylo.safetensors whose weights are begun
                        //!< with, or empty
  std::string device = "cpu";
  /** Gets a CSV of points and static confidence per validation recording, named by its number and
   * name; empty for none. */
  std::string mask_folder;
  /** Print the validation table of `start`, or else of what is in the folder, and write nothing. */
  bool validate_only = false;
  std::function<bool()>
      stopped;  //!< asked before each step: save and end the training? May be empty
  std::function<void(const std::string&)> report;  //!< one line of progress at a time
};

/** Trains DyLO by the sections [train], [network], [loss], [augmentation] and [data] of `config`.
 * What it validates and writes are the running mean of the weights. The last checkpoint before the
 * learning rate goes down stays as checkpoint_before_decay.safetensors.
 * The same config and seed give the same weights on one CPU thread, stopped and resumed or not.
 * \throws UserError. */
void trainDylo(const Config& config, const DyloTrainRequest& request);
}  // namespace dyslam
