// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train only.
#pragma once

#include <dyslam/nets/TensorFile.h>
#include <torch/torch.h>

#include <string>

namespace dyslam
{
/** Copies the weights of a network of the same shape. \param file where they are from, for the
 * message \throws UserError if one is missing there, or is of another shape. */
void copyWeights(torch::nn::Module& to, const torch::nn::Module& from, const std::string& file);

/** Running mean of a training's weights, which does better than the last ones (Polyak and Juditsky
 * 1992). \param mean, now of the same shape \param step that gave `now`, from 0 \param decay share
 * of the mean that stays; less in the first steps, which it forgets sooner. */
void updateMean(torch::nn::Module& mean,
                const torch::nn::Module& now,
                std::int64_t step,
                double decay);

/** What Adam (or AdamW) remembers of each of its parameters, for a checkpoint. */
void setOptimizerState(TensorFile& file, torch::optim::Optimizer& optimizer);

/** \throws UserError if the file lacks one or has it in another shape. */
void loadOptimizerState(const TensorFile& file, torch::optim::Optimizer& optimizer);
}  // namespace dyslam
