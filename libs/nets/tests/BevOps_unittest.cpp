// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <limits>

namespace
{
using torch::Tensor;

TEST(PillarMax, AgreesWithALoop)
{
  torch::manual_seed(1);
  const auto features = torch::rand({200, 5});
  const auto cell = torch::randint(0, 30, {200}, torch::kInt32);
  const auto out = dyslam::pillarMax(features, cell, 31);
  for (std::int64_t c = 0; c < 31; ++c)
  {
    auto best = torch::zeros({5});
    for (std::int64_t i = 0; i < 200; ++i)
    {
      if (cell[i].item<int>() == c)
      {
        best = torch::max(best, features[i]);
      }
    }
    EXPECT_TRUE(torch::equal(best, out[c])) << "cell " << c;
  }
}

TEST(PillarMax, GradientGoesToTheWinner)
{
  const auto features = torch::tensor({{1.0F, 5.0F}, {3.0F, 2.0F}, {4.0F, 4.0F}}).requires_grad_();
  const auto cell = torch::tensor({2, 2, 0}, torch::kInt32);
  const auto out = dyslam::pillarMax(features, cell, 3);
  const auto weight = torch::tensor({{10.0F, 20.0F}, {30.0F, 40.0F}, {50.0F, 60.0F}});
  (out * weight).sum().backward();
  EXPECT_TRUE(
      torch::equal(features.grad(), torch::tensor({{0.0F, 60.0F}, {50.0F, 0.0F}, {10.0F, 20.0F}})));
}

TEST(PillarMax, NoPoints)
{
  const auto out = dyslam::pillarMax(torch::zeros({0, 4}), torch::zeros({0}, torch::kInt32), 6);
  EXPECT_EQ(out.sizes(), (std::vector<std::int64_t>{6, 4}));
  EXPECT_EQ(out.abs().max().item<float>(), 0);
}

struct Case
{
  Tensor source = torch::randn({40, 8});
  Tensor target = torch::randn({12, 15, 8});
  Tensor centre = torch::rand({40, 2}) * torch::tensor({22.0F, 18.0F}) - 3;
};

TEST(Correlate, AgreesWithGridSample)
{
  torch::manual_seed(2);
  const Case c;
  for (const int radius : {1, 2, 5})
  {
    const auto fast = dyslam::correlate(c.source, c.target, c.centre, radius);
    const auto slow = dyslam::correlateSlow(c.source, c.target, c.centre, radius);
    ASSERT_EQ(fast.sizes(), slow.sizes());
    EXPECT_LT((fast - slow).abs().max().item<float>(), 2e-5) << "radius " << radius;
  }
}

TEST(Correlate, GradientsAgreeWithGridSample)
{
  torch::manual_seed(3);
  Case c;
  const auto weight = torch::randn({40, 25});
  const auto gradients = [&](auto&& op)
  {
    const auto s = c.source.clone().requires_grad_();
    const auto t = c.target.clone().requires_grad_();
    (op(s, t, c.centre, 2) * weight).sum().backward();
    return std::pair(s.grad(), t.grad());
  };
  const auto [fast_s, fast_t] = gradients(dyslam::correlate);
  const auto [slow_s, slow_t] = gradients(dyslam::correlateSlow);
  EXPECT_LT((fast_s - slow_s).abs().max().item<float>(), 5e-5);
  EXPECT_LT((fast_t - slow_t).abs().max().item<float>(), 5e-5);
}

TEST(Correlate, FindsAShiftedPattern)
{
  torch::manual_seed(4);
  const auto map = torch::randn({20, 20, 32}) * 3;
  // The cell at (10, 9) of the first map is the one at (13, 7) of the second.
  const auto source = map[7][13].unsqueeze(0);
  const auto window = dyslam::correlate(source, map, torch::tensor({{10.0F, 9.0F}}), 5);
  const auto peak = dyslam::peakOffset(window, 5);
  EXPECT_NEAR(peak[0][0].item<float>(), 3, 1e-3);
  EXPECT_NEAR(peak[0][1].item<float>(), -2, 1e-3);
  EXPECT_GT(peak[0][2].item<float>(), 0.99F);
}

TEST(Correlate, OutsideAndInvalidAreZero)
{
  const auto map = torch::ones({4, 4, 8});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto out = dyslam::correlate(torch::ones({3, 8}), map,
                                     torch::tensor({{-50.0F, 2.0F}, {1e9F, 1e9F}, {nan, nan}}), 1);
  EXPECT_EQ(out.abs().max().item<float>(), 0);
  EXPECT_EQ(dyslam::correlate(torch::ones({0, 8}), map, torch::zeros({0, 2}), 1).size(0), 0);
}
}  // namespace
