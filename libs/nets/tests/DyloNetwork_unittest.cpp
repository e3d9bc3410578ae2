// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloNetwork.h>
#include <dyslam/nets/Threads.h>
#include <gtest/gtest.h>

#include "SyntheticScan.h"

namespace dyslam
{
namespace
{
constexpr auto real = torch::kFloat;

Pose motion(double forward)
{
  return poseFromYpr(forward, 0.02, 0, 0.01, 0, 0);
}

struct Pair
{
  ScanTensors scan1, scan2;
};

/** \param T_2_1 pose of scan 1 in scan 2's frame. */
Pair roomPair(const Pose& T_2_1, int beams = 64)
{
  return {toTensors(prepareScan(testing::room(beams, 1800, T_2_1))),
          toTensors(prepareScan(testing::room(beams, 1800)))};
}

std::vector<DyloStage> run(DyloNetwork& net, const Pair& pair)
{
  return net->forward(net->encode(pair.scan1), net->encode(pair.scan2),
                      PoseTensors::identity(real));
}

TEST(DyloNetwork, EveryShapeRunsAndHasGradients)
{
  const Pair pair = roomPair(motion(0.3));
  for (const DyloHead head : {DyloHead::gauss_newton, DyloHead::regression})
  {
    for (const DyloMask mask : {DyloMask::none, DyloMask::lonet, DyloMask::attention})
    {
      torch::manual_seed(1);
      DyloNetworkOptions options;
      options.head = head;
      options.mask = mask;
      DyloNetwork net(options);
      const auto stages = run(net, pair);
      ASSERT_EQ(stages.size(), head == DyloHead::gauss_newton ? 7U : 4U);
      torch::Tensor loss = torch::zeros({});
      for (const DyloStage& stage : stages)
      {
        ASSERT_TRUE(stage.pose.translation.isfinite().all().item<bool>());
        loss = loss + stage.pose.translation.square().sum() + stage.pose.rotation.square().sum() +
               stage.pose.rotation.sum() + stage.target.square().mean() + stage.noise;
      }
      loss.backward();
      for (const auto& parameter : net->named_parameters())
      {
        const bool idle = head == DyloHead::regression && parameter.key() == "isotropic";
        if (idle || !parameter.value().grad().defined())
        {
          // Inputs of the mask have no gradients without a mask.
          EXPECT_TRUE(idle || mask == DyloMask::none) << parameter.key();
          continue;
        }
        EXPECT_TRUE(parameter.value().grad().isfinite().all().item<bool>()) << parameter.key();
      }
    }
  }
}

TEST(DyloNetwork, CudaGivesTheSameToRounding)
{
  if (!torch::cuda::is_available())
  {
    GTEST_SKIP() << "no CUDA";
  }
  for (const DyloHead head : {DyloHead::gauss_newton, DyloHead::regression})
  {
    torch::Tensor expected;
    std::vector<torch::Tensor> expected_gradients;
    for (const torch::Device device : {torch::Device(torch::kCPU), torch::Device(torch::kCUDA)})
    {
      torch::manual_seed(1);
      DyloNetworkOptions options;
      options.head = head;
      DyloNetwork net(options);
      net->to(device);
      const auto scan1 = toTensors(prepareScan(testing::room(64, 1800, motion(0.3))), device);
      const auto scan2 = toTensors(prepareScan(testing::room(64, 1800)), device);
      const auto last = net->forward(net->encode(scan1), net->encode(scan2),
                                     PoseTensors::identity(torch::dtype(real).device(device)))
                            .back();
      const auto pose = torch::cat({last.pose.translation, last.pose.rotation.flatten()});
      pose.square().sum().backward();
      std::vector<torch::Tensor> gradients;
      for (const auto& parameter : net->parameters())
      {
        gradients.push_back(parameter.grad().defined() ? parameter.grad().cpu() : torch::Tensor());
      }
      if (device.is_cpu())
      {
        expected = pose.detach();
        expected_gradients = gradients;
        continue;
      }
      EXPECT_TRUE(torch::allclose(pose.detach().cpu(), expected, 1e-3, 1e-3));
      for (std::size_t i = 0; i < gradients.size(); ++i)
      {
        ASSERT_EQ(gradients[i].defined(), expected_gradients[i].defined());
        if (gradients[i].defined())
        {
          const auto scale = expected_gradients[i].norm().item<double>() + 1e-4;
          EXPECT_LT((gradients[i] - expected_gradients[i]).norm().item<double>(), 0.02 * scale)
              << i;
        }
      }
    }
  }
}

TEST(DyloNetwork, UntrainedGaussNewtonHeadEstimatesAKnownMotion)
{
  torch::manual_seed(2);
  DyloNetworkOptions options;
  options.fine_passes = 6;
  DyloNetwork net(options);
  const torch::NoGradGuard no_grad;
  for (const double forward : {0.15, -0.15})
  {
    const Pose truth = motion(forward);
    const Pose estimate = run(net, roomPair(truth)).back().pose.toPose();
    EXPECT_NEAR(estimate.translation().x(), forward, 0.05);
    EXPECT_NEAR(rotationAngle(estimate.inverse() * truth), 0, 0.01);
  }
}

TEST(DyloNetwork, EqualScansGiveTheIdentity)
{
  torch::manual_seed(3);
  DyloNetwork net(DyloNetworkOptions{});
  const torch::NoGradGuard no_grad;
  const Pose estimate = run(net, roomPair(Pose::Identity())).back().pose.toPose();
  EXPECT_LT(logSE3(estimate).norm(), 0.02);
}

TEST(DyloNetwork, ForwardAndBackwardMotionsAreInverse)
{
  torch::manual_seed(6);
  DyloNetworkOptions options;
  options.mask = DyloMask::none;
  options.fine_passes = 6;
  DyloNetwork net(options);
  const torch::NoGradGuard no_grad;
  const Pose truth = motion(0.15);
  const Pair pair = roomPair(truth);
  const Pose there = run(net, pair).back().pose.toPose();
  const Pose back = run(net, {pair.scan2, pair.scan1}).back().pose.toPose();
  EXPECT_LT(motionSize(logSE3(there.inverse() * truth)), 0.005);
  EXPECT_LT(motionSize(logSE3(there * back)), 0.005);
}

TEST(DyloNetwork, HandlesEmptyAndSparseScans)
{
  torch::manual_seed(4);
  DyloNetwork net(DyloNetworkOptions{});
  const torch::NoGradGuard no_grad;
  const ScanTensors empty = toTensors(prepareScan({}));
  const ScanTensors full = toTensors(prepareScan(testing::room(16, 1800)));
  for (const Pair& pair :
       {Pair{empty, full}, Pair{full, empty}, Pair{empty, empty}, Pair{full, full}})
  {
    for (const DyloStage& stage : run(net, pair))
    {
      EXPECT_TRUE(stage.pose.translation.isfinite().all().item<bool>());
      EXPECT_TRUE(stage.weight.isfinite().all().item<bool>());
    }
  }
}

TEST(DyloNetwork, SameSeedGivesTheSameBytes)
{
  const Pair pair = roomPair(motion(0.3));
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> results;
  for (int i = 0; i < 2; ++i)
  {
    torch::manual_seed(5);
    DyloNetwork net(DyloNetworkOptions{});
    results.push_back(run(net, pair).back().pose.translation);
  }
  EXPECT_TRUE(torch::equal(results[0], results[1]));
}

/** The hand-written layers are deterministic; torch's sums may differ by rounding. */
TEST(DyloNetwork, IsIndependentOfTheNumberOfThreads)
{
  const Pair pair = roomPair(motion(0.3));
  const torch::NoGradGuard no_grad;
  torch::manual_seed(5);
  DyloNetwork net(DyloNetworkOptions{});
  const int before = torch::get_num_threads();
  useTorchThreads(1);
  const torch::Tensor one = run(net, pair).back().pose.translation;
  useTorchThreads(3);
  const torch::Tensor three = run(net, pair).back().pose.translation;
  useTorchThreads(before);
  EXPECT_LT((one - three).abs().max().item<float>(), 1e-5F);
}
}  // namespace
}  // namespace dyslam
