// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/DysegModel.h>
#include <gtest/gtest.h>
#include <torch/torch.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>

namespace
{
using dyslam::BevOptions;
using dyslam::DysegModel;
using dyslam::DysegNetworkOptions;

BevOptions smallGrid()
{
  BevOptions grid;
  grid.cells = 128;
  return grid;
}

/** Flat ground with some posts and walls. */
std::vector<Eigen::Vector3f> street(unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-20, 20);
  std::uniform_real_distribution<float> height(-1.2F, 1.5F);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 4000; ++i)
  {
    points.emplace_back(place(random), place(random), -1.7F);
  }
  for (int i = 0; i < 60; ++i)
  {
    const Eigen::Vector2f at(place(random), place(random));
    for (int k = 0; k < 30; ++k)
    {
      points.emplace_back(at.x() + 0.01F * static_cast<float>(k % 7), at.y(), height(random));
    }
  }
  return points;
}

TEST(DysegNet, EveryParameterHasAGradient)
{
  torch::manual_seed(1);
  dyslam::DysegNet net{DysegNetworkOptions()};
  const auto current = dyslam::makeBevScan(street(1), smallGrid());
  auto before = street(1);
  for (auto& p : before)
  {
    p.x() += 0.3F;
  }
  const auto past = dyslam::makeBevScan(before, smallGrid());
  const auto a = net->encode(current);
  const auto b = net->encode(past);
  const dyslam::TeacherMotions teacher;
  const auto match = net->match(current, a, b, &teacher);
  const auto cells = net->segmentCells(current, a, b, teacher.fine, 2);
  std::vector<std::int32_t> indices(current.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto points = net->segmentPoints(current, a, b, past.rays, cells, indices);
  const auto flow = net->pointFlow(current, a, cells, indices);
  ASSERT_EQ(points.size(0), static_cast<std::int64_t>(indices.size()));
  ASSERT_EQ(flow.size(0), points.size(0));
  ASSERT_EQ(cells.residual.size(), 2U);
  auto loss = points.square().sum() + flow.square().sum() + cells.logit.square().sum() +
              (a.static_logit - 1).square().sum() + (match.correlation + 1).square().sum() +
              (match.coarse_correlation + 1).square().sum();
  for (const auto& r : cells.residual)
  {
    loss = loss + r.square().sum();
  }
  loss.backward();
  for (const auto& p : net->named_parameters())
  {
    EXPECT_TRUE(p.value().grad().defined() && p.value().grad().abs().max().item<float>() > 0)
        << p.key();
  }
}

TEST(DysegModel, HasOneProbabilityPerPointAndHandlesEmptyScans)
{
  const DysegModel model(DysegNetworkOptions(), smallGrid(), 1);
  auto points = street(3);
  points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  const auto some = model.encode(points);
  const auto result = model.compare(*some, *model.encode(street(4)));
  ASSERT_EQ(result.moving_probability.size(), points.size());
  for (const float p : result.moving_probability)
  {
    EXPECT_TRUE(p >= 0 && p <= 1);
  }
  EXPECT_EQ(result.moving_probability.front(), 0) << "ground";
  EXPECT_EQ(result.cell_centre.size(), result.cell_flow.size());

  const auto nothing = model.encode({});
  EXPECT_TRUE(model.compare(*nothing, *some).moving_probability.empty());
  const auto alone = model.compare(*some, *nothing);
  EXPECT_EQ(*std::max_element(alone.moving_probability.begin(), alone.moving_probability.end()), 0);
  EXPECT_FALSE(alone.static_flow.converged);
  const auto one = model.encode({{3, 2, 1}});
  EXPECT_EQ(model.compare(*one, *some).moving_probability.size(), 1U);
}

TEST(DysegModel, ADeviceThatThereIsNotIsRefused)
{
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("dyslam_device_" + std::to_string(::getpid()) + ".safetensors"))
                               .string();
  torch::manual_seed(1);
  dyslam::saveDyseg({dyslam::DysegNet(DysegNetworkOptions()), smallGrid()}, file);
  EXPECT_THROW(DysegModel(file, 1, "abacus"), dyslam::UserError);
  if (!torch::cuda::is_available())
  {
    EXPECT_THROW(DysegModel(file, 1, "cuda"), dyslam::UserError);
  }
  std::filesystem::remove(file);
}

TEST(DysegModel, CudaGivesTheSameToRounding)
{
  if (!torch::cuda::is_available())
  {
    GTEST_SKIP() << "no CUDA";
  }
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("dyslam_cuda_" + std::to_string(::getpid()) + ".safetensors"))
                               .string();
  torch::manual_seed(1);
  dyslam::saveDyseg({dyslam::DysegNet(DysegNetworkOptions()), smallGrid()}, file);
  const DysegModel cpu(file);
  const DysegModel cuda(file, 1, "cuda");
  std::filesystem::remove(file);
  auto before = street(1);
  for (auto& p : before)
  {
    p.x() += 0.3F;
  }
  const auto expected = cpu.compare(*cpu.encode(street(1)), *cpu.encode(before));
  const auto found = cuda.compare(*cuda.encode(street(1)), *cuda.encode(before));
  EXPECT_LT((expected.static_flow.motion.translation - found.static_flow.motion.translation).norm(),
            1e-3);
  ASSERT_EQ(expected.cell_flow.size(), found.cell_flow.size());
  for (std::size_t i = 0; i < found.cell_flow.size(); ++i)
  {
    EXPECT_LT((expected.cell_flow[i] - found.cell_flow[i]).norm(), 1e-3) << i;
    EXPECT_NEAR(expected.cell_moving_probability[i], found.cell_moving_probability[i], 1e-3) << i;
  }
  for (std::size_t i = 0; i < found.moving_probability.size(); ++i)
  {
    EXPECT_NEAR(expected.moving_probability[i], found.moving_probability[i], 1e-3) << i;
  }
}

/** Cells beyond the voting square do not vote for the static motion. */
TEST(DysegModel, WithoutStaticCellsTheMotionIsTheGuess)
{
  BevOptions grid;
  grid.cells = 640;
  const DysegModel model(DysegNetworkOptions(), grid, 1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i)
  {
    const float y = 0.02F * static_cast<float>(i) - 20;
    points.emplace_back(55.0F, y, -1.7F);
    points.emplace_back(56.0F, y, -0.5F);
  }
  const auto scan = model.encode(points);
  const auto result = model.compare(*scan, *scan);
  EXPECT_FALSE(result.cell_centre.empty());
  EXPECT_FALSE(result.static_flow.converged);
  EXPECT_EQ(result.static_flow.motion.translation.norm(), 0) << "of a search: none";
  dyslam::PlanarPrior guess;
  guess.motion.translation = {1, 0.2};
  guess.motion.yaw = 0.03;
  const auto fit = model.match(*scan, *scan, &guess);
  EXPECT_FALSE(fit.converged);
  EXPECT_EQ(fit.motion.translation, guess.motion.translation);
  EXPECT_EQ(fit.motion.yaw, guess.motion.yaw);
}

TEST(DysegModel, IsIndependentOfTheNumberOfThreads)
{
  const int before = torch::get_num_threads();
  const DysegModel one(DysegNetworkOptions(), smallGrid(), 1, 1);
  const DysegModel two(DysegNetworkOptions(), smallGrid(), 1, 2);
  const auto by_one = one.compare(*one.encode(street(1)), *one.encode(street(0)));
  const auto by_two = two.compare(*two.encode(street(1)), *two.encode(street(0)));
  EXPECT_EQ(by_one.moving_probability, by_two.moving_probability);
  EXPECT_EQ(by_one.cell_moving_probability, by_two.cell_moving_probability);
  EXPECT_EQ(by_one.cell_flow, by_two.cell_flow);
  EXPECT_EQ(torch::get_num_threads(), 1);  // torch's own operations share no threads
  torch::set_num_threads(before);
}

TEST(DysegFile, RejectsFilesThatCannotBeWritten)
{
  dyslam::DysegNetwork network;
  network.net = dyslam::DysegNet(DysegNetworkOptions());
  EXPECT_THROW(saveDyseg(network, "/nowhere/dyseg.safetensors"), dyslam::UserError);
}

TEST(DysegFile, RejectsGridsOutOfRange)
{
  const auto file =
      (std::filesystem::temp_directory_path() / "dyslam_dyseg_grid.safetensors").string();
  dyslam::DysegNetwork network;
  network.net = dyslam::DysegNet(DysegNetworkOptions());
  const auto refusalOf = [&](const BevOptions& grid) -> std::string
  {
    network.grid = grid;
    saveDyseg(network, file);
    try
    {
      (void)dyslam::loadDyseg(file);
    }
    catch (const dyslam::UserError& error)
    {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusalOf(smallGrid()), "");
  BevOptions grid = smallGrid();
  grid.cell_size = 0;
  EXPECT_NE(refusalOf(grid).find(file + ": [grid] cell_size"), std::string::npos);
  grid = smallGrid();
  grid.cells = 100;
  EXPECT_NE(refusalOf(grid).find(file + ": [grid] cells"), std::string::npos);
  std::filesystem::remove(file);
}

TEST(DysegFile, RoundTripsWeightsAndRejectsOtherFiles)
{
  torch::manual_seed(7);
  const auto folder = std::filesystem::temp_directory_path();
  const auto file = (folder / "dyslam_dyseg_test.safetensors").string();
  dyslam::DysegNetwork network;
  network.net = dyslam::DysegNet(DysegNetworkOptions());
  network.grid = smallGrid();
  saveDyseg(network, file);
  const auto back = dyslam::loadDyseg(file);
  EXPECT_EQ(back.grid.cells, 128);
  const auto written = network.net->named_parameters();
  for (const auto& p : back.net->named_parameters())
  {
    EXPECT_LT((p.value() - written[p.key()]).abs().max().item<float>(), 1e-3) << p.key();
  }
  EXPECT_THROW(DysegModel(file + ".missing"), dyslam::UserError);
  std::ofstream(file) << "no weights";
  EXPECT_THROW(DysegModel model(file), dyslam::UserError);
  std::filesystem::remove(file);
}
}  // namespace
