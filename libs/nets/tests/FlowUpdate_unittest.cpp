// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/FlowUpdate.h>
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <vector>

namespace
{
using torch::Tensor;

/** Row indices of the 3 x 3 neighbours of each cell of a full map. */
Tensor allNeighbours(int width, int height)
{
  std::vector<std::int32_t> table;
  for (int i = 0; i < width * height; ++i)
  {
    for (int k = 0; k < 9; ++k)
    {
      const int x = i % width + k % 3 - 1;
      const int y = i / width + k / 3 - 1;
      table.push_back(x < 0 || y < 0 || x >= width || y >= height ? -1 : y * width + x);
    }
  }
  return dyslam::tableTensor(table, 9);
}

/** Convex upsampling from its formula, one cell at a time. */
Tensor slowUpsample(const Tensor& flow, const Tensor& weights, int row, int x, int y, int sub)
{
  const auto w = weights[row].view({9, -1}).select(1, sub);
  double total = 0;
  auto sum = torch::zeros({2});
  for (int k = 0; k < 9; ++k)
  {
    const int nx = x + k % 3 - 1;
    const int ny = y + k / 3 - 1;
    if (nx < 0 || ny < 0 || nx >= flow.size(1) || ny >= flow.size(0))
    {
      continue;
    }
    const double share = std::exp(w[k].item<double>());
    total += share;
    sum += share * flow[ny][nx];
  }
  return sum / total;
}

TEST(FlowUpdate, UpsamplingMatchesALoop)
{
  torch::manual_seed(2);
  const auto flow = torch::randn({5, 6, 2});
  const auto weights = torch::randn({30, 9 * 16});
  const std::vector<int> x{0, 5, 2, 3, 5};
  const std::vector<int> y{0, 4, 2, 0, 2};
  const std::vector<int> sub{0, 15, 7, 9, 3};
  std::vector<std::int64_t> subs(sub.begin(), sub.end());
  std::vector<std::int64_t> cells;
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    cells.push_back(y[i] * 6 + x[i]);
  }
  const auto fast = dyslam::upsampleFlow(flow.view({30, 2}), weights, allNeighbours(6, 5),
                                         torch::tensor(cells), torch::tensor(subs), 4);
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    const auto slow = slowUpsample(flow, weights, static_cast<int>(cells[i]), x[i], y[i], sub[i]);
    EXPECT_LT((fast[static_cast<std::int64_t>(i)] - slow).abs().max().item<float>(), 1e-5) << i;
  }
}

/** The GRU equations with the unit's parameters. */
TEST(ConvGru, MatchesItsEquations)
{
  torch::manual_seed(3);
  dyslam::ConvGru gru(3, 2);
  const auto state = torch::randn({1, 3, 4, 4});
  const auto input = torch::randn({1, 2, 4, 4});
  const auto p = gru->named_parameters();
  const auto conv = [&](const Tensor& x, const char* name)
  {
    return torch::conv2d(x, p[std::string(name) + ".weight"], p[std::string(name) + ".bias"], 1, 1);
  };
  const auto gates = torch::sigmoid(conv(torch::cat({state, input}, 1), "gates"));
  const auto z = gates.slice(1, 0, 3);
  const auto r = gates.slice(1, 3, 6);
  const auto q = torch::tanh(conv(torch::cat({r * state, input}, 1), "candidate"));
  const auto expected = (1 - z) * state + z * q;
  const auto rows = [](const Tensor& map) { return map.view({-1, 16}).t().contiguous(); };
  const auto found = gru(rows(state), rows(input), allNeighbours(4, 4));
  EXPECT_LT((found - rows(expected)).abs().max().item<float>(), 1e-5);
}

TEST(FlowUpdate, GradientsReachEveryParameter)
{
  torch::manual_seed(4);
  dyslam::FlowUpdate update(6, 5, 1);
  const auto around = allNeighbours(3, 1);
  const auto out = update(torch::randn({3, 6}), torch::randn({3, 9}), torch::zeros({3, 2}), around);
  (out.change.square().sum() + out.state.square().sum()).backward();
  for (const auto& p : update->named_parameters())
  {
    ASSERT_TRUE(p.value().grad().defined()) << p.key();
    EXPECT_GT(p.value().grad().abs().max().item<float>(), 0) << p.key();
  }
}
}  // namespace
