// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train only.
#pragma once

#include <dyslam/core/Error.h>
#include <torch/torch.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

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

/** Loads weights into a network; torch itself would take over their shape, too.
 * \throws std::invalid_argument if they are of another shape. */
inline void loadSameShape(torch::nn::Module& network, torch::serialize::InputArchive& weights)
{
  std::vector<std::vector<std::int64_t>> shapes;
  for (const torch::Tensor& parameter : network.parameters())
  {
    shapes.push_back(parameter.sizes().vec());
  }
  network.load(weights);
  const auto loaded = network.parameters();
  for (std::size_t i = 0; i < shapes.size(); ++i)
  {
    if (loaded[i].sizes().vec() != shapes[i])
    {
      throw std::invalid_argument("weights of another shape");
    }
  }
}
}  // namespace dyslam
