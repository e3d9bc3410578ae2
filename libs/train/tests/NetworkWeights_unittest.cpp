// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
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

struct SomeNetworkOptions : Options
{
  int channels = 8;
  double width = 0.5;
  void describe(OptionsVisitor& v) override
  {
    v.integer("channels", channels, 1, 64, "channels");
    v.real("width", width, 0.1, 4, "width");
  }
};

TEST(NetworkWeights, ThoseOfAnotherNetworkAreRefused)
{
  const SomeNetworkOptions of_weights;
  SomeNetworkOptions given;
  EXPECT_NO_THROW(requireSameNetwork(of_weights, given, "w.safetensors"));
  given.width = 1;
  const auto message = [&](const std::string& otherwise)
  {
    try
    {
      requireSameNetwork(of_weights, given, "w.safetensors", otherwise);
    }
    catch (const UserError& error)
    {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ("w.safetensors: trained with [network] width = 0.5, not 1; set it to 0.5", message(""));
  EXPECT_EQ(
      "w.safetensors: trained with [network] width = 0.5, not 1; set it to 0.5, or leave it out",
      message("leave it out"));
}
}  // namespace
}  // namespace dyslam
