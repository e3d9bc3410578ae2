// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <array>
#include <cmath>
#include <limits>

namespace
{
using torch::Tensor;

TEST(PillarMax, MatchesALoop)
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

TEST(PillarMax, GradientGoesToTheMaximum)
{
  const auto features = torch::tensor({{1.0F, 5.0F}, {3.0F, 2.0F}, {4.0F, 4.0F}}).requires_grad_();
  const auto cell = torch::tensor({2, 2, 0}, torch::kInt32);
  const auto out = dyslam::pillarMax(features, cell, 3);
  const auto weight = torch::tensor({{10.0F, 20.0F}, {30.0F, 40.0F}, {50.0F, 60.0F}});
  (out * weight).sum().backward();
  EXPECT_TRUE(
      torch::equal(features.grad(), torch::tensor({{0.0F, 60.0F}, {50.0F, 0.0F}, {10.0F, 20.0F}})));
}

TEST(PillarMax, HandlesNoPoints)
{
  const auto out = dyslam::pillarMax(torch::zeros({0, 4}), torch::zeros({0}, torch::kInt32), 6);
  EXPECT_EQ(out.sizes(), (std::vector<std::int64_t>{6, 4}));
  EXPECT_EQ(out.abs().max().item<float>(), 0);
}

/** A sparse map with every third cell empty. */
dyslam::SparseMap sparseMap(std::int64_t height, std::int64_t width, std::int64_t channels)
{
  auto index = torch::empty({height, width}, torch::kInt32);
  std::int32_t rows = 0;
  for (std::int64_t i = 0; i < index.numel(); ++i)
  {
    index.data_ptr<std::int32_t>()[i] = i % 3 == 1 ? -1 : rows++;
  }
  return {torch::randn({rows, channels}), index, torch::randn({channels})};
}

/** A map without empty cells. */
dyslam::SparseMap fullMap(const Tensor& map)
{
  const auto cells = map.size(0) * map.size(1);
  return {map.reshape({cells, map.size(2)}),
          torch::arange(cells, torch::kInt32).view({map.size(0), map.size(1)}),
          torch::zeros({map.size(2)})};
}

struct Case
{
  Tensor source = torch::randn({40, 8});
  dyslam::SparseMap target = sparseMap(12, 15, 8);
  Tensor centre = torch::rand({40, 2}) * torch::tensor({22.0F, 18.0F}) - 3;
};

TEST(Correlate, MatchesGridSample)
{
  torch::manual_seed(2);
  const Case c;
  for (const int radius : {1, 2, 5})
  {
    const auto found = dyslam::correlate(c.source, c.target, c.centre, radius);
    const auto expected = dyslam::correlateReference(c.source, c.target, c.centre, radius);
    ASSERT_EQ(found.sizes(), expected.sizes());
    EXPECT_LT((found - expected).abs().max().item<float>(), 2e-5) << "radius " << radius;
  }
}

TEST(Correlate, GradientsMatchGridSample)
{
  torch::manual_seed(3);
  Case c;
  const auto weight = torch::randn({40, 25});
  const auto gradients = [&](auto&& op)
  {
    const auto s = c.source.clone().requires_grad_();
    const auto t = c.target.rows.clone().requires_grad_();
    const auto e = c.target.empty.clone().requires_grad_();
    (op(s, dyslam::SparseMap{t, c.target.index, e}, c.centre, 2) * weight).sum().backward();
    return std::array<Tensor, 3>{s.grad(), t.grad(), e.grad()};
  };
  const auto found = gradients(dyslam::correlate);
  const auto expected = gradients(dyslam::correlateReference);
  for (std::size_t i = 0; i < found.size(); ++i)
  {
    EXPECT_LT((found[i] - expected[i]).abs().max().item<float>(), 2e-4) << i;
  }
}

TEST(Correlate, FindsAShiftedPattern)
{
  torch::manual_seed(4);
  const auto map = torch::randn({20, 20, 32}) * 3;
  // Cell (10, 9) of the first map equals cell (13, 7) of the second.
  const auto source = map[7][13].unsqueeze(0);
  const auto window = dyslam::correlate(source, fullMap(map), torch::tensor({{10.0F, 9.0F}}), 5);
  const auto peak = dyslam::peakOffset(window, 5);
  EXPECT_NEAR(peak[0][0].item<float>(), 3, 1e-3);
  EXPECT_NEAR(peak[0][1].item<float>(), -2, 1e-3);
  EXPECT_GT(peak[0][2].item<float>(), 0.99F);
}

TEST(PeakOffset, MatchesTorch)
{
  torch::manual_seed(6);
  const auto window = torch::randn({300, 49}) * 4;
  const auto found = dyslam::peakOffset(window, 3);
  EXPECT_LT((found - dyslam::peakOffsetReference(window, 3)).abs().max().item<float>(), 1e-5);
}

TEST(Correlate, OutsideAndInvalidAreZero)
{
  const auto map = torch::ones({4, 4, 8});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto out = dyslam::correlate(torch::ones({3, 8}), fullMap(map),
                                     torch::tensor({{-50.0F, 2.0F}, {1e9F, 1e9F}, {nan, nan}}), 1);
  EXPECT_EQ(out.abs().max().item<float>(), 0);
  EXPECT_EQ(dyslam::correlate(torch::ones({0, 8}), fullMap(map), torch::zeros({0, 2}), 1).size(0),
            0);
}
}  // namespace
