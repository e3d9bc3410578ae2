// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train only.
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/nets/TensorFile.h>
#include <torch/torch.h>

#include <cstdint>
#include <string>

namespace dyslam
{
/** Copies the weights of a network of the same shape. \param file file of the weights, for the
 * message \throws UserError naming the first weight that is missing in `from` or of another shape.
 */
void copyWeights(torch::nn::Module& to, const torch::nn::Module& from, const std::string& file);

/** Requires that the weights of a file were trained for the same network. \param of_weights,given
 * options of one type, of the file and of the user \param otherwise what else the user can do than
 * to change the key; may be empty \throws UserError naming the file, the first key that differs and
 * both values. */
void requireSameNetwork(const Options& of_weights,
                        const Options& given,
                        const std::string& file,
                        const std::string& otherwise = "");

/** Exponential moving average of the weights of a training, which scores better than the last
 * weights (Polyak and Juditsky 1992). \param[in,out] mean averaged weights \param now weights after
 * the step, of the same shape \param step step that gave `now`, from 0 \param decay weight of the
 * mean; less in the first steps, so that these are forgotten sooner. */
void updateMean(torch::nn::Module& mean,
                const torch::nn::Module& now,
                std::int64_t step,
                double decay);

/** Limits the norm of all gradients together to `clip` and takes a step of the optimizer. If the
 * norm is not finite, the gradients are set to zero and no step is taken: it would destroy the
 * weights. \return the norm before the limit */
double clippedStep(torch::optim::Optimizer& optimizer, double clip);

/** Stores the state of Adam (or AdamW) for each of its parameters, for a checkpoint. */
void setOptimizerState(TensorFile& file, torch::optim::Optimizer& optimizer);

/** Replaces the state of each parameter that has one in the file; a parameter that had no gradient
 * before the checkpoint has none. \throws UserError naming the file if a state is incomplete or of
 * another shape. */
void loadOptimizerState(const TensorFile& file, torch::optim::Optimizer& optimizer);
}  // namespace dyslam
