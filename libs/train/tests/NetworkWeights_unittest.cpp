// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/NetworkWeights.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
TEST(NetworkWeights, GradientsThatAreNotFiniteGiveNoStep)
{
  torch::nn::Linear layer(2, 1);
  torch::optim::AdamW optimizer(layer->parameters(), torch::optim::AdamWOptions(0.1));
  const auto addGradient = [&] { layer(torch::ones({1, 2})).sum().backward(); };
  const torch::Tensor before = layer->weight.detach().clone();
  addGradient();
  layer->weight.mutable_grad().fill_(std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(std::isfinite(clippedStep(optimizer, 1)));
  EXPECT_TRUE(torch::equal(layer->weight, before));
  addGradient();
  EXPECT_NEAR(clippedStep(optimizer, 1), std::sqrt(3), 1e-6) << "of this gradient alone";
  EXPECT_FALSE(torch::equal(layer->weight, before));
  EXPECT_TRUE(layer->weight.isfinite().all().item<bool>());
}
}  // namespace
}  // namespace dyslam
