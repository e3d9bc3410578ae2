// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>

#include <functional>
#include <string>

namespace dyslam
{
struct DyloTrainRequest
{
  std::string output;   //!< folder for checkpoint.safetensors, dylo.safetensors, log.csv,
                        //!< validation.csv, effective.ini
  bool resume = false;  //!< continue from checkpoint.safetensors in `output`
  std::string start;    //!< a checkpoint.safetensors or dylo.safetensors with the initial weights,
                        //!< or empty: none
  std::string device = "cpu";
  /** Folder for a CSV file of points and static confidence per validation recording, named by its
   * number and name; empty: not written. */
  std::string mask_folder;
  /** Print the validation table of `start`, or if that is empty of the weights in `output`, and
   * write nothing. A dylo.safetensors must have been trained with the settings of [network]. */
  bool validate_only = false;
  std::function<bool()>
      stopped;  //!< polled before each step: true saves and ends the training; may be empty
  std::function<void(const std::string&)> report;  //!< one line of progress at a time
};

/** Trains DyLO by the sections [train], [network], [loss], [augmentation] and [data] of `config`.
 * It validates and saves the exponential moving average of the weights. The last checkpoint before
 * the learning rate decays is kept as checkpoint_before_decay.safetensors. The same config and seed
 * give the same weights on one CPU thread, stopped and resumed or not.
 * \throws UserError. */
void trainDylo(const Config& config, const DyloTrainRequest& request);

/** Every setting of trainDylo() with its default. */
[[nodiscard]] Config dyloTrainDefaults();
}  // namespace dyslam
