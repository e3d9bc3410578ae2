// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train only.
#pragma once

#include <dyslam/core/Error.h>
#include <torch/torch.h>

#include <string>

namespace dyslam
{
/** Weights of `own` become (1 - share) of themselves and `share` of the other's.
 * \param file where the other is from, for the message
 * \throws UserError if the other lacks a weight, or has it in another shape. */
inline void blendWeights(torch::nn::Module& own,
                         const torch::nn::Module& other,
                         double share,
                         const std::string& file)
{
  const torch::NoGradGuard no_grad;
  const auto theirs = other.named_parameters();
  for (auto& weight : own.named_parameters())
  {
    const torch::Tensor* given = theirs.find(weight.key());
    if (given == nullptr || given->sizes() != weight.value().sizes())
    {
      throw UserError(file + ": weights of another shape of network");
    }
    weight.value().mul_(1 - share).add_(given->to(weight.value().device()), share);
  }
}
}  // namespace dyslam
