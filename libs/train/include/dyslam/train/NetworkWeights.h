// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train only.
#pragma once

#include <dyslam/nets/TensorFile.h>
#include <torch/torch.h>

#include <string>

namespace dyslam
{
/** Weights of `own` become (1 - share) of themselves and `share` of the other's.
 * \param file where the other is from, for the message
 * \throws UserError if the other lacks a weight, or has it in another shape. */
void blendWeights(torch::nn::Module& own,
                  const torch::nn::Module& other,
                  double share,
                  const std::string& file);

/** What Adam (or AdamW) remembers of each of its parameters, for a checkpoint. */
void setOptimizerState(TensorFile& file, torch::optim::Optimizer& optimizer);

/** \throws UserError if the file lacks one or has it in another shape. */
void loadOptimizerState(const TensorFile& file, torch::optim::Optimizer& optimizer);
}  // namespace dyslam
