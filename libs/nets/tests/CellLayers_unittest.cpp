// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/CellLayers.h>
#include <dyslam/nets/CellPyramid.h>
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <algorithm>
#include <random>
#include <vector>

#include "OccupiedProducts.h"

namespace
{
using torch::Tensor;

/** Random points, many of them alone in their cells, some in one corner of the grid. */
dyslam::BevScan someScan(unsigned seed, int count)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-6.39F, 6.39F);
  dyslam::BevScan scan;
  scan.cells = 64;
  scan.cell_size = 0.2F;
  scan.corner = Eigen::Vector2f(-6.4F, -6.4F);
  for (int i = 0; i < count; ++i)
  {
    const Eigen::Vector3f p(place(random), i < 3 ? -6.39F : place(random), 0);
    scan.points.push_back(p);
    scan.cell.push_back(static_cast<int>((p.y() + 6.4F) / 0.2F) * 64 +
                        static_cast<int>((p.x() + 6.4F) / 0.2F));
  }
  return scan;
}

/** A level's rows as a map with zeros in empty cells, 1 x C x H x W. */
Tensor denseOf(const dyslam::CellLevel& level, const Tensor& rows)
{
  auto map = torch::zeros({level.width * level.width, rows.size(1)});
  for (std::size_t i = 0; i < level.size(); ++i)
  {
    map[level.number[i]] = rows[static_cast<std::int64_t>(i)];
  }
  return map.t().reshape({1, rows.size(1), level.width, level.width});
}

TEST(CellPyramid, ContainTheCellsOfThePoints)
{
  const auto scan = someScan(1, 200);
  const dyslam::CellPyramid levels(scan);
  const auto& quarter = levels.quarter;
  EXPECT_EQ(quarter.width, 16);
  EXPECT_TRUE(std::is_sorted(quarter.number.begin(), quarter.number.end()));
  const auto centres = dyslam::cellCentres(quarter, scan);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const auto row = static_cast<std::size_t>(quarter.row_of_point[i]);
    ASSERT_LT(row, quarter.size());
    EXPECT_LE((centres[row] - scan.points[i].head<2>()).cwiseAbs().maxCoeff(), 0.4001F);
    EXPECT_EQ(quarter.row_of_cell[static_cast<std::size_t>(quarter.number[row])],
              quarter.row_of_point[i]);
  }
  const dyslam::CellPyramid none(someScan(1, 0));
  EXPECT_EQ(none.full.size(), 0U);
  EXPECT_TRUE(dyslam::convolutionRows(none.full, none.half).empty());
}

TEST(CellConv, MatchesADenseConvolution)
{
  torch::manual_seed(1);
  const dyslam::CellPyramid levels(someScan(2, 400));
  for (const auto* to : {&levels.full, &levels.half})
  {
    dyslam::CellConv layer(5, 7);
    const auto rows = torch::randn({static_cast<std::int64_t>(levels.full.size()), 5});
    const auto table = dyslam::tableTensor(dyslam::convolutionRows(levels.full, *to), 9);
    const auto found = layer(rows, table, 0.1);
    const auto dense =
        torch::leaky_relu(torch::conv2d(denseOf(levels.full, rows), layer->weight, layer->bias,
                                        levels.full.width / to->width, 1),
                          0.1);
    const auto number = torch::tensor(to->number, torch::kInt32).to(torch::kInt64);
    const auto expected = dense.view({7, -1}).t().index_select(0, number);
    EXPECT_LT((found - expected).abs().max().item<float>(), 1e-5) << to->width;
  }
}

TEST(CellConv, GradientsMatchTorch)
{
  torch::manual_seed(2);
  const dyslam::CellPyramid levels(someScan(3, 900));
  const auto table = dyslam::tableTensor(dyslam::convolutionRows(levels.full, levels.half), 9);
  ASSERT_GT(table.size(0), 256) << "more than one block";
  const auto weight_in = torch::randn({6, 36});
  const auto rows_in = torch::randn({static_cast<std::int64_t>(levels.full.size()), 4});
  const auto upstream = torch::randn({table.size(0), 6});
  const auto gradients = [&](auto&& op)
  {
    const auto rows = rows_in.clone().requires_grad_();
    const auto weight = weight_in.clone().requires_grad_();
    const auto bias = torch::zeros({6}).requires_grad_();
    (op(rows, weight, bias) * upstream).sum().backward();
    return std::vector<Tensor>{rows.grad(), weight.grad(), bias.grad()};
  };
  const auto fast = gradients([&](const Tensor& rows, const Tensor& weight, const Tensor& bias)
                              { return dyslam::gatheredLinear(rows, table, weight, bias, 0); });
  const auto slow = gradients(
      [&](const Tensor& rows, const Tensor& weight, const Tensor& bias)
      {
        const auto padded = torch::cat({rows, torch::zeros({1, 4})});
        const auto index = table.to(torch::kInt64);
        const auto found =
            padded.index_select(0, index.masked_fill(index.lt(0), rows.size(0)).reshape({-1}));
        return torch::addmm(bias, found.view({table.size(0), 36}), weight.t()).relu();
      });
  for (std::size_t i = 0; i < fast.size(); ++i)
  {
    EXPECT_LT((fast[i] - slow[i]).abs().max().item<float>(), 2e-4) << i;
  }
}

TEST(GatherRows, GathersRowsZerosAndGradients)
{
  const auto rows = torch::tensor({{1.0F, 2.0F}, {3.0F, 4.0F}}).requires_grad_();
  const auto table = dyslam::tableTensor({1, -1, 1, 0}, 2);
  const auto out = dyslam::gatherRows(rows, table);
  EXPECT_TRUE(
      torch::equal(out, torch::tensor({{3.0F, 4.0F, 0.0F, 0.0F}, {3.0F, 4.0F, 1.0F, 2.0F}})));
  out.sum().backward();
  EXPECT_TRUE(torch::equal(rows.grad(), torch::tensor({{1.0F, 1.0F}, {2.0F, 2.0F}})));
}

TEST(CellConv, IsIndependentOfTheNumberOfThreads)
{
  torch::manual_seed(3);
  const dyslam::CellPyramid levels(someScan(4, 900));
  const auto table = dyslam::tableTensor(dyslam::convolutionRows(levels.full, levels.full), 9);
  dyslam::CellConv layer(8, 8);
  const auto rows = torch::randn({static_cast<std::int64_t>(levels.full.size()), 8});
  const int before = torch::get_num_threads();
  torch::set_num_threads(1);
  const auto one = layer(rows, table);
  torch::set_num_threads(3);
  const auto three = layer(rows, table);
  torch::set_num_threads(before);
  EXPECT_TRUE(torch::equal(one, three));
}

TEST(OccupiedProducts, WideVectorsGiveTheSameSums)
{
  constexpr std::int64_t positions = 9;
  constexpr std::int64_t channels = 11;
  constexpr std::int64_t cells = 37;
  std::mt19937 random(3);
  std::normal_distribution<float> value;
  std::uniform_int_distribution<int> row(-20, cells - 1);  // about a third is empty
  for (const std::int64_t outputs : {1, 16, 24, 48, 64, 100})
  {
    std::vector<float> rows(cells * channels);
    std::vector<float> weight(static_cast<std::size_t>(outputs * positions * channels));
    std::vector<std::int32_t> table(cells * positions);
    std::generate(rows.begin(), rows.end(), [&] { return value(random); });
    std::generate(weight.begin(), weight.end(), [&] { return value(random); });
    std::generate(table.begin(), table.end(), [&] { return std::max(-1, row(random)); });
    const auto sums = [&](bool wide)
    {
      const dyslam::OccupiedProducts products(rows.data(), channels, weight.data(), positions,
                                              outputs, wide);
      std::vector<float> padded(static_cast<std::size_t>(cells * products.width()), 0.5F);
      products.addTo(table.data(), cells, padded.data());
      std::vector<float> result;
      for (std::int64_t i = 0; i < cells; ++i)
      {
        const auto first = padded.begin() + i * products.width();
        result.insert(result.end(), first, first + outputs);
      }
      return result;
    };
    const std::vector<float> wide = sums(true);
    EXPECT_EQ(sums(false), wide) << outputs;
    double expected = 0.5;  // the last output of the last cell
    for (std::int64_t p = 0; p < positions; ++p)
    {
      const std::int32_t at = table[static_cast<std::size_t>((cells - 1) * positions + p)];
      for (std::int64_t c = 0; at >= 0 && c < channels; ++c)
      {
        expected +=
            rows[static_cast<std::size_t>(at * channels + c)] *
            weight[static_cast<std::size_t>(((outputs - 1) * positions + p) * channels + c)];
      }
    }
    EXPECT_NEAR(wide.back(), expected, 1e-4) << outputs;
  }
}
}  // namespace
