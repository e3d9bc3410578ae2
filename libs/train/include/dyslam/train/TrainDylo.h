// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/train/TrainRequest.h>

#include <string>

namespace dyslam
{
/** `start` is a checkpoint.safetensors or a dylo.safetensors. With `validate_only` a
 * dylo.safetensors must have been trained with the settings of [network]. */
struct DyloTrainRequest : TrainRequest
{
  /** Folder for a CSV file of points and static confidence per validation recording, named by its
   * number and name; empty: not written. */
  std::string mask_folder;
};

/** Trains DyLO by the sections [train], [network], [loss], [augmentation] and [data] of `config`,
 * and writes dylo.safetensors, checkpoint.safetensors, log.csv, validation.csv and effective.ini.
 * It validates and saves the exponential moving average of the weights. The last checkpoint before
 * the learning rate decays is kept as checkpoint_before_decay.safetensors. The same config and seed
 * give the same weights on one CPU thread, stopped and resumed or not.
 * \throws UserError. */
void trainDylo(const Config& config, const DyloTrainRequest& request);

/** Every setting of trainDylo() with its default. */
[[nodiscard]] Config dyloTrainDefaults();
}  // namespace dyslam
