// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/DysegLosses.h>
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
using torch::Tensor;

/** The Lovasz extension by its definition: errors sorted, each times how much IoU it costs. */
double slowLovasz(const std::vector<float>& logit,
                  const std::vector<int>& label,
                  const std::vector<float>& weight)
{
  std::vector<std::size_t> order(logit.size());
  std::vector<double> error(logit.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = i;
    error[i] = std::abs(static_cast<double>(label[i]) - 1 / (1 + std::exp(-logit[i])));
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return error[a] > error[b]; });
  // Jaccard loss if the first k points are wrong.
  const auto jaccard = [&](std::size_t wrong)
  {
    double lost = 0;
    double positives = 0;
    double extra = 0;
    for (std::size_t k = 0; k < order.size(); ++k)
    {
      positives += label[order[k]] == 1 ? weight[order[k]] : 0;
      if (k < wrong)
      {
        (label[order[k]] == 1 ? lost : extra) += weight[order[k]];
      }
    }
    return 1 - (positives - lost) / (positives + extra);
  };
  double sum = 0;
  for (std::size_t k = 0; k < order.size(); ++k)
  {
    sum += error[order[k]] * (jaccard(k + 1) - jaccard(k));
  }
  return sum;
}

TEST(DysegLosses, LovaszAgreesWithItsDefinition)
{
  const std::vector<float> logit{0.3F, -1.2F, 2.0F, 0.7F, -0.4F, 1.9F};
  const std::vector<int> label{1, 0, 1, 0, 1, 0};
  const std::vector<float> weight{1, 2, 0.5F, 7, 1, 3};
  const auto fast =
      dyslam::lovaszLoss(torch::tensor(logit), torch::tensor(label), torch::tensor(weight));
  EXPECT_NEAR(fast.item<double>(), slowLovasz(logit, label, weight), 1e-5);
  const auto sure =
      dyslam::lovaszLoss(torch::tensor({30.0F, -30.0F}), torch::tensor({1, 0}), torch::ones({2}));
  EXPECT_NEAR(sure.item<float>(), 0, 1e-6);
  const auto none = torch::zeros({0});
  EXPECT_EQ(dyslam::lovaszLoss(none, none, none).item<float>(), 0);
}

TEST(DysegLosses, CorrelationLossIsLeastAtTheTrueOffset)
{
  const auto offset = torch::tensor({{1.0F, -2.0F}});
  const auto moving = torch::tensor({false});
  const auto peakAt = [](int x, int y)
  {
    auto c = torch::zeros({1, 49});
    c[0][(y + 3) * 7 + x + 3] = 10;
    return c;
  };
  const auto loss = [&](const Tensor& c)
  { return dyslam::correlationLoss(c, offset, moving, 3).item<double>(); };
  EXPECT_LT(loss(peakAt(1, -2)), 0.01);
  EXPECT_GT(loss(peakAt(-2, 1)), 5);
  // An offset halfway between two cells is shared by both.
  const auto half = torch::tensor({{0.5F, 0.0F}});
  const auto value = dyslam::correlationLoss(torch::zeros({1, 49}), half, moving, 3).item<double>();
  EXPECT_NEAR(value, std::log(49), 1e-5);
}

TEST(DysegLosses, UnknownAndFarOffsetsDontCount)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto offset = torch::tensor({{nan, nan}, {9.0F, 0.0F}});
  const auto c = torch::randn({2, 49}).requires_grad_();
  const auto loss = dyslam::correlationLoss(c, offset, torch::tensor({false, true}), 3);
  EXPECT_EQ(loss.item<float>(), 0);
}

TEST(DysegLosses, MoversWeighAsMuchAsTheStatic)
{
  const auto value = torch::tensor({1.0F, 1.0F, 1.0F, 5.0F});
  const auto moving = torch::tensor({false, false, false, true});
  EXPECT_FLOAT_EQ(dyslam::balancedMean(value, moving).item<float>(), 6);
  EXPECT_FLOAT_EQ(dyslam::balancedMean(value, torch::zeros({4}, torch::kBool)).item<float>(), 2);
}

/** Of recordings with labels per point only the flow of the static is known. */
TEST(DysegLosses, MoversOfUnknownFlowAreSegmentedButNotMatched)
{
  dyslam::DysegClipScene scene;
  scene.sensor = dyslam::sim::SensorKind::vlp16;
  auto sample = makeSample(dyslam::simulateClip(500000001, 3, true, scene), 2, 0);
  dyslam::BevOptions grid;
  grid.cells = 256;
  const auto lossOf = [&](const Eigen::Vector2f& moving_flow)
  {
    for (std::size_t i = 0; i < sample.label.size(); ++i)
    {
      sample.flow[i] =
          sample.label[i] == dyslam::DysegSample::moving_point ? moving_flow : sample.flow[i];
    }
    torch::manual_seed(1);
    dyslam::DysegNet net{dyslam::DysegNetworkOptions()};
    dyslam::RandomDraws draws(1, 2);
    auto loss = dysegLoss(net, sample, grid, {0, 0}, {}, draws);
    loss.total.backward();
    for (const auto& parameter : net->named_parameters())
    {
      EXPECT_TRUE(!parameter.value().grad().defined() ||
                  parameter.value().grad().isfinite().all().item<bool>())
          << parameter.key();
    }
    return loss;
  };
  ASSERT_GT(std::count(sample.label.begin(), sample.label.end(), dyslam::DysegSample::moving_point),
            30);
  const auto known = lossOf({0.5F, 0.3F});
  const auto unknown = lossOf(Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_TRUE(std::isfinite(unknown.total.item<double>()));
  EXPECT_LT(unknown.flow, known.flow);
  EXPECT_LT(unknown.matching, known.matching);
  EXPECT_NEAR(unknown.cell, known.cell, 1e-6) << "moving all the same";
  EXPECT_NEAR(unknown.point, known.point, 1e-6);
}

TEST(DysegLosses, CudaGivesTheSameGradientsToRounding)
{
  if (!torch::cuda::is_available())
  {
    GTEST_SKIP() << "no CUDA";
  }
  dyslam::DysegClipScene scene;
  scene.sensor = dyslam::sim::SensorKind::vlp16;
  const auto sample = makeSample(dyslam::simulateClip(500000001, 3, true, scene), 2, 0);
  dyslam::BevOptions grid;
  grid.cells = 256;
  std::vector<Tensor> expected;
  double expected_loss = 0;
  for (const torch::Device device : {torch::Device(torch::kCPU), torch::Device(torch::kCUDA)})
  {
    torch::manual_seed(1);
    dyslam::DysegNet net{dyslam::DysegNetworkOptions()};
    net->to(device);
    dyslam::RandomDraws draws(1, 2);
    const auto loss = dysegLoss(net, sample, grid, {0, 0}, {}, draws);
    loss.total.backward();
    std::vector<Tensor> gradients;
    for (const auto& parameter : net->parameters())
    {
      gradients.push_back(parameter.grad().cpu());
    }
    if (device.is_cpu())
    {
      expected = gradients;
      expected_loss = loss.total.item<double>();
      continue;
    }
    EXPECT_NEAR(loss.total.item<double>(), expected_loss, 1e-3 * expected_loss);
    for (std::size_t i = 0; i < gradients.size(); ++i)
    {
      const double scale = expected[i].norm().item<double>() + 1e-4;
      EXPECT_LT((gradients[i] - expected[i]).norm().item<double>(), 0.02 * scale) << i;
    }
  }
}
}  // namespace
