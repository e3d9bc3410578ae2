// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/FlowUpdate.h>
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>

namespace
{
using torch::Tensor;

TEST(FlowUpdate, GatherUndoesScatter)
{
  torch::manual_seed(1);
  const auto rows = torch::randn({3, 4});
  const auto cell = torch::tensor({1, 7, 11}, torch::kInt64);
  const auto map = dyslam::scatterCells(rows, cell, 3, 5);
  EXPECT_EQ(map.sizes(), (std::vector<std::int64_t>{1, 4, 3, 5}));
  EXPECT_TRUE(torch::equal(map.squeeze(0).select(1, 1).select(1, 2), rows[1]));  // y 1, x 2
  EXPECT_TRUE(torch::equal(dyslam::gatherCells(map, cell), rows));
  EXPECT_NEAR(map.abs().sum().item<float>(), rows.abs().sum().item<float>(), 1e-4);
}

/** Written from the formula, one cell at a time. */
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

TEST(FlowUpdate, UpsamplingAgreesWithALoop)
{
  torch::manual_seed(2);
  const auto flow = torch::randn({5, 6, 2});
  const auto weights = torch::randn({4, 9 * 16});
  const std::vector<int> row{0, 1, 2, 3, 3};
  const std::vector<int> x{0, 5, 2, 3, 5};
  const std::vector<int> y{0, 4, 2, 0, 2};
  const std::vector<int> sub{0, 15, 7, 9, 3};
  std::vector<std::int64_t> rows(row.begin(), row.end());
  std::vector<std::int64_t> subs(sub.begin(), sub.end());
  std::vector<std::int64_t> cells;
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    cells.push_back(y[i] * 6 + x[i]);
  }
  const auto fast = dyslam::upsampleFlow(flow, weights, torch::tensor(rows), torch::tensor(cells),
                                         torch::tensor(subs), 4);
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    const auto slow = slowUpsample(flow, weights, row[i], x[i], y[i], sub[i]);
    EXPECT_LT((fast[static_cast<std::int64_t>(i)] - slow).abs().max().item<float>(), 1e-5) << i;
  }
}

/** The unit by its formulas, from its own parameters. */
TEST(ConvGru, AgreesWithItsFormula)
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
  EXPECT_LT((gru(state, input) - expected).abs().max().item<float>(), 1e-5);
}

TEST(FlowUpdate, GradientsReachEveryParameter)
{
  torch::manual_seed(4);
  dyslam::FlowUpdate update(6, 5, 1);
  const auto cell = torch::tensor({0, 5, 9}, torch::kInt64);
  const auto out =
      update(torch::randn({1, 6, 4, 4}), torch::randn({3, 9}), torch::zeros({3, 2}), cell);
  (out.change.square().sum() + out.state.square().sum()).backward();
  for (const auto& p : update->named_parameters())
  {
    ASSERT_TRUE(p.value().grad().defined()) << p.key();
    EXPECT_GT(p.value().grad().abs().max().item<float>(), 0) << p.key();
  }
}
}  // namespace
