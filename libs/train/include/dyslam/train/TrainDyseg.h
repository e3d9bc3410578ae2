// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/train/TrainRequest.h>

namespace dyslam
{
/** Trains DySeg's network by the sections [train], [network], [grid], [augmentation] and [loss] of
 * `config`.
 *
 * Writes `dyseg.safetensors`, the weights so far (exponential moving average),
 * `checkpoint.safetensors`, the state to resume from, `train.csv`, `validation.csv` and
 * `effective.ini`; `checkpoint_before_decay.safetensors` is the last one before the learning rate
 * decays. The data of a step depend on seed and step alone, so that a training that was stopped and
 * resumed gives the same weights; so does any number of threads. Sums on CUDA differ from run to
 * run by rounding.
 *
 * \param request `start` is a dyseg.safetensors of the same [grid]; only the number of cells may
 *   differ. With `validate_only` the weights decide grid and network; where `config` has the
 *   section [grid] or [network], they must have been trained with it
 * \throws UserError. */
void trainDyseg(const Config& config, const TrainRequest& request);

/** Every setting of trainDyseg() with its default. */
[[nodiscard]] Config dysegTrainDefaults();
}  // namespace dyslam
