// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/GaussNewton.h>
#include <dyslam/nets/Layers.h>
#include <dyslam/nets/PointLinear.h>
#include <gtest/gtest.h>

#include <functional>

#include "SyntheticScan.h"

namespace dyslam
{
namespace
{
/** Largest relative difference between autograd and central differences of a scalar function. */
double gradientError(const std::function<torch::Tensor()>& loss, torch::Tensor variable, double h)
{
  if (variable.grad().defined())
  {
    variable.mutable_grad().zero_();
  }
  loss().backward();
  const torch::Tensor grad = variable.grad().clone().reshape({-1});
  const torch::NoGradGuard no_grad;
  torch::Tensor flat = variable.view({-1});
  double worst = 0;
  const std::int64_t step = std::max<std::int64_t>(1, flat.size(0) / 24);
  for (std::int64_t i = 0; i < flat.size(0); i += step)
  {
    const double value = flat[i].item<double>();
    flat[i] = value + h;
    const double plus = loss().item<double>();
    flat[i] = value - h;
    const double minus = loss().item<double>();
    flat[i] = value;
    const double numeric = (plus - minus) / (2 * h);
    worst =
        std::max(worst, std::abs(numeric - grad[i].item<double>()) / (std::abs(numeric) + 1e-2));
  }
  return worst;
}

TEST(PointLinear, MatchesMatrixProductAndItsGradients)
{
  torch::manual_seed(1);
  const auto real = torch::dtype(torch::kDouble).requires_grad(true);
  const torch::Tensor x = torch::randn({2500, 5}, real);
  const torch::Tensor w = torch::randn({7, 5}, real);
  const torch::Tensor b = torch::randn({7}, real);
  const torch::Tensor mix = torch::randn({2500, 7}, torch::kDouble);
  const torch::Tensor ours = pointLinear(x, w, b, 0.1);
  const torch::Tensor reference = torch::leaky_relu(torch::addmm(b, x, w.t()), 0.1);
  EXPECT_LT((ours - reference).abs().max().item<double>(), 1e-12);
  const auto ours_grad = torch::autograd::grad({(ours * mix).sum()}, {x, w, b});
  const auto plain_grad = torch::autograd::grad({(reference * mix).sum()}, {x, w, b});
  for (std::size_t i = 0; i < 3; ++i)
  {
    EXPECT_LT((ours_grad[i] - plain_grad[i]).abs().max().item<double>(), 1e-9) << i;
  }
}

TEST(PointLinear, SameBytesForAnyNumberOfThreads)
{
  const torch::Tensor x = torch::randn({5000, 24});
  const torch::Tensor w = torch::randn({64, 24});
  const torch::Tensor b = torch::randn({64});
  const int threads = torch::get_num_threads();
  torch::set_num_threads(1);
  const torch::Tensor one = pointLinear(x, w, b, 0.1);
  torch::set_num_threads(2);
  const torch::Tensor two = pointLinear(x, w, b, 0.1);
  torch::set_num_threads(threads);
  EXPECT_TRUE(torch::equal(one, two));
}

TEST(Window, ContainsTheCellOfThePoint)
{
  const PreparedScan scan = prepareScan(testing::room(64, 1800));
  const ScanTensors tensors = toTensors(scan);
  const Window window =
      windowAround(tensors.image_xyz, tensors, tensors.rows, PreparedScan::columns, 0, 0);
  std::int64_t wrong = 0;
  for (std::int64_t cell = 0; cell < tensors.image_xyz.size(0); ++cell)
  {
    if (scan.source[static_cast<std::size_t>(cell)] >= 0)
    {
      wrong += window.index[cell][0].item<std::int64_t>() != cell;
      cell += 96;  // only a sample of the cells: item() is slow
    }
  }
  EXPECT_LE(wrong, 2);  // rounding at a column's edge
}

TEST(Window, NearestOfAWindowIsMostlyTheGlobalNearest)
{
  const ScanTensors scan = toTensors(prepareScan(testing::room(64, 1800)));
  const ScanTensors::Level& level = scan.levels[1];
  const torch::Tensor points = level.xyz + 0.02;
  const Window window = windowAround(points, scan, level.rows, level.cols, 1, 2);
  const torch::Tensor far = (1 - level.valid) * 1e6;
  const torch::Tensor in_window =
      ((gather(level.xyz, window.index) - points.unsqueeze(1)).norm(2, 2) +
       far.index_select(0, window.index.reshape({-1})).reshape(window.index.sizes()))
          .amin(1);
  const torch::Tensor brute = (torch::cdist(points, level.xyz) + far.unsqueeze(0)).amin(1);
  EXPECT_GE((in_window - brute).min().item<float>(), -1e-2);  // cdist is coarse
  const torch::Tensor same = (in_window - brute).abs().lt(1e-2).to(torch::kFloat) * level.valid;
  EXPECT_GT((same.sum() / level.valid.sum()).item<float>(), 0.97);
}

TEST(Window, BetweenGridsWrapsColumnsAndClampsRows)
{
  const Window window = windowBetween(4, 16, 4, 16, 3, 3, torch::kCPU);
  EXPECT_EQ(window.index[0][0].item<std::int64_t>(), 15);  // clamped row, column before 0
  EXPECT_EQ(window.inside[0][0].item<float>(), 0);
  EXPECT_EQ(window.index[0][4].item<std::int64_t>(), 0);
  EXPECT_EQ(window.inside[0][4].item<float>(), 1);
  const Window down = windowBetween(8, 32, 4, 16, 4, 4, torch::kCPU);
  // Node (1, 1) covers rows 2-3 and columns 2-3; its window is rows 1-4 and columns 1-4.
  EXPECT_EQ(down.index[17][0].item<std::int64_t>(), 1 * 32 + 1);
  EXPECT_EQ(down.index[17][15].item<std::int64_t>(), 4 * 32 + 4);
}

TEST(SetConv, MatchesALoopOverPoints)
{
  torch::manual_seed(2);
  const ScanTensors scan = toTensors(prepareScan(testing::room(64, 900)));
  const ScanTensors::Level& from = scan.levels[3];
  const ScanTensors::Level& to = scan.levels[4];
  const Window window = windowBetween(from.rows, from.cols, to.rows, to.cols, 4, 4, torch::kCPU);
  SetConv conv(6, std::vector<std::int64_t>{8, 12}, 0.4);
  const torch::Tensor features = torch::randn({from.xyz.size(0), 6});
  const torch::NoGradGuard no_grad;
  const torch::Tensor fast = conv->forward(features, from, to, window);
  const auto p = conv->named_parameters(true);
  for (std::int64_t node = 0; node < to.xyz.size(0); node += 7)
  {
    torch::Tensor best;
    for (std::int64_t k = 0; k < window.index.size(1); ++k)
    {
      const std::int64_t other = window.index[node][k].item<std::int64_t>();
      if (window.inside[node][k].item<float>() == 0 || from.valid[other].item<float>() == 0)
      {
        continue;
      }
      const torch::Tensor unit = to.xyz[node].norm() * 0.4 + 0.2;
      torch::Tensor x =
          torch::cat({((from.xyz[other] - to.xyz[node]) / unit).clamp(-8, 8), features[other]});
      x = torch::leaky_relu(torch::mv(p["mlp.weight"], x) + p["mlp.bias"], 0.1);
      x = torch::leaky_relu(torch::mv(p["mlp.rest.weight0"], x) + p["mlp.rest.bias0"], 0.1);
      best = best.defined() ? torch::maximum(best, x) : x;
    }
    const torch::Tensor expected = best.defined() ? best : torch::zeros({12});
    EXPECT_LT((fast[node] - expected).abs().max().item<float>(), 1e-4) << node;
  }
}

TEST(Mlp, GroupInputMatchesTheConcatenation)
{
  torch::manual_seed(6);
  Mlp mlp(Sizes{9, 8, 2}, true);
  const torch::Tensor places = torch::randn({50, 6, 4});
  const torch::Tensor own = torch::randn({50, 5});
  const torch::Tensor joined = torch::cat({places, own.unsqueeze(1).expand({50, 6, 5})}, 2);
  const torch::Tensor difference = mlp->forward(places, own) - mlp->forward(joined);
  EXPECT_LT(difference.abs().max().item<float>(), 1e-5F);
}

TEST(ScanTensors, UpdatedPointsMatchTheMovedScan)
{
  PreparedScan scan = prepareScan(testing::room(64, 1800));
  ScanTensors tensors = toTensors(scan);
  const torch::Tensor before = tensors.levels[1].xyz;
  for (std::size_t cell = 0; cell < scan.points.size(); ++cell)
  {
    if (scan.source[cell] >= 0)
    {
      scan.points[cell] += Eigen::Vector3f(0.1F, 0, 0.2F);
    }
  }
  updatePoints(scan, tensors);
  const ScanTensors expected = toTensors(scan);
  EXPECT_TRUE(torch::equal(tensors.image_xyz, expected.image_xyz));
  for (std::size_t l = 0; l < expected.levels.size(); ++l)
  {
    EXPECT_TRUE(torch::equal(tensors.levels[l].xyz, expected.levels[l].xyz)) << l;
  }
  EXPECT_FALSE(torch::equal(tensors.levels[1].xyz, before));
}

TEST(DynamicMask, WeightsSumToOneAndIgnoreInvalidPoints)
{
  torch::manual_seed(3);
  for (const DyloMask kind : {DyloMask::none, DyloMask::lonet, DyloMask::attention})
  {
    DynamicMask mask(kind, 16, 8);
    torch::Tensor valid = torch::ones({100});
    valid.slice(0, 40, 60).zero_();
    const MaskLogits logits = mask->forward(torch::randn({100, 16}), torch::randn({100, 8}), valid);
    const torch::Tensor weight = maskWeights(logits, valid);
    EXPECT_NEAR(weight.sum().item<float>(), 1, 1e-5);
    EXPECT_EQ(weight.slice(0, 40, 60).abs().max().item<float>(), 0);
    EXPECT_EQ(maskWeights(logits, torch::zeros({100})).abs().max().item<float>(), 0);
    if (kind == DyloMask::none)
    {
      EXPECT_NEAR(weight.max().item<float>(), 1.0 / 80, 1e-5);
    }
  }
}

TEST(GaussNewton, SolveHasTheRightGradient)
{
  torch::manual_seed(4);
  const auto real = torch::dtype(torch::kDouble);
  const torch::Tensor root = torch::randn({6, 6}, real.requires_grad(true));
  const torch::Tensor b = torch::randn({6}, real.requires_grad(true));
  const torch::Tensor mix = torch::randn({6}, torch::kDouble);
  const auto loss = [&]
  {
    const torch::Tensor a = torch::matmul(root, root.t()) + 2 * torch::eye(6, torch::kDouble);
    return (solveSpd(a, b) * mix).sum();
  };
  EXPECT_LT(gradientError(loss, root, 1e-6), 1e-6);
  EXPECT_LT(gradientError(loss, b, 1e-6), 1e-6);
}

/** Points on three planes, and the same transformed by a known motion. */
PoseStepProblem knownMotion(const PoseTensors& motion)
{
  torch::manual_seed(5);
  const torch::Tensor target = 10 * torch::randn({600, 3}, torch::kDouble);
  torch::Tensor normal = torch::randn({600, 3}, torch::kDouble);
  normal = normal / normal.norm(2, 1, true);
  // points such that motion.apply(points) = target
  const torch::Tensor points = torch::matmul(target - motion.translation, motion.rotation);
  return {points,
          normal,
          (normal * target).sum(1),
          target,
          torch::full({600}, 1.0 / 600, torch::kDouble),
          {}};
}

TEST(GaussNewton, RecoversAKnownMotionForwardAndInverse)
{
  for (const double sign : {1.0, -1.0})
  {
    Vector6 tangent;
    tangent << 0.5, -0.1, 0.05, 0.01, -0.02, 0.05;
    const PoseTensors motion = PoseTensors::from(expSE3(sign * tangent), torch::kDouble);
    PoseStepProblem problem = knownMotion(motion);
    PoseTensors pose = PoseTensors::identity(torch::kDouble);
    const torch::Tensor start = problem.points;
    for (int i = 0; i < 4; ++i)
    {
      problem.points = pose.apply(start);
      pose = gaussNewtonStep(problem).update * pose;
    }
    EXPECT_LT(logSE3(pose.toPose().inverse() * expSE3(sign * tangent)).norm(), 1e-5);
  }
}

TEST(GaussNewton, PointToPointTermAloneConverges)
{
  Vector6 tangent;
  tangent << 0.3, 0.1, -0.05, 0.01, 0.02, -0.05;
  PoseStepProblem problem = knownMotion(PoseTensors::from(expSE3(tangent), torch::kDouble));
  problem.normal = torch::zeros_like(problem.normal);
  problem.offset = torch::zeros_like(problem.offset);
  problem.isotropic = torch::ones({}, torch::kDouble);
  PoseTensors pose = PoseTensors::identity(torch::kDouble);
  const torch::Tensor start = problem.points;
  for (int i = 0; i < 4; ++i)
  {
    problem.points = pose.apply(start);
    pose = gaussNewtonStep(problem).update * pose;
  }
  EXPECT_LT(logSE3(pose.toPose().inverse() * expSE3(tangent)).norm(), 1e-5);
}

TEST(GaussNewton, StepHasTheRightGradient)
{
  Vector6 tangent;
  tangent << 0.3, 0.1, -0.05, 0.01, 0.02, -0.05;
  PoseStepProblem problem = knownMotion(PoseTensors::from(expSE3(tangent), torch::kDouble));
  problem.isotropic = torch::full({}, 0.1, torch::kDouble);
  problem.weight.set_requires_grad(true);
  problem.offset = problem.offset.clone().set_requires_grad(true);
  const auto loss = [&]
  {
    const PoseTensors update = gaussNewtonStep(problem).update;
    return update.rotation.sum() + update.translation.square().sum();
  };
  EXPECT_LT(gradientError(loss, problem.weight, 1e-7), 1e-4);
  EXPECT_LT(gradientError(loss, problem.offset, 1e-6), 1e-4);
}

TEST(GaussNewton, StepIsTheSameWithAndWithoutGradients)
{
  Vector6 tangent;
  tangent << 0.3, 0.1, -0.05, 0.01, 0.02, -0.05;
  PoseStepProblem problem = knownMotion(PoseTensors::from(expSE3(tangent), torch::kDouble));
  for (torch::Tensor* t :
       {&problem.points, &problem.normal, &problem.offset, &problem.target, &problem.weight})
  {
    *t = t->to(torch::kFloat);
  }
  for (const bool isotropic : {false, true})
  {
    problem.isotropic = isotropic ? torch::full({}, 0.1) : torch::Tensor();
    const GaussNewtonStep with = gaussNewtonStep(problem);
    const torch::NoGradGuard no_grad;
    const GaussNewtonStep without = gaussNewtonStep(problem);
    EXPECT_LT(logSE3(with.update.toPose().inverse() * without.update.toPose()).norm(), 1e-5);
    const torch::Tensor difference = with.normal_matrix - without.normal_matrix;
    EXPECT_LT(difference.abs().max().item<float>(),
              1e-5F * with.normal_matrix.abs().max().item<float>());
  }
}

TEST(GaussNewton, ZeroWeightsGiveTheIdentity)
{
  PoseStepProblem problem = knownMotion(PoseTensors::identity(torch::kDouble));
  problem.weight = torch::zeros_like(problem.weight);
  const PoseTensors update = gaussNewtonStep(problem).update;
  EXPECT_LT(logSE3(update.toPose()).norm(), 1e-12);
}

TEST(GaussNewton, QuaternionsAndRotationVectorsAgree)
{
  const torch::Tensor v = torch::tensor({0.2, -0.3, 0.4}, torch::kDouble);
  const double angle = v.norm().item<double>();
  const torch::Tensor q = torch::cat(
      {torch::tensor({std::cos(angle / 2)}, torch::kDouble), v / angle * std::sin(angle / 2)});
  EXPECT_LT((expRotation(v) - rotationOfQuaternion(3 * q)).abs().max().item<double>(), 1e-12);
  EXPECT_LT((expRotation(0 * v) - torch::eye(3, torch::kDouble)).abs().max().item<double>(), 1e-12);
}

TEST(GaussNewton, PlaneFitAgreesWithTorch)
{
  torch::manual_seed(6);
  const torch::Tensor m = torch::randn({50, 3, 5});
  const torch::Tensor covariance = torch::matmul(m, m.transpose(1, 2));
  const PlaneFit fit = fitPlanes(covariance);
  const torch::Tensor spread = std::get<0>(torch::linalg_eigh(covariance)).clamp_min(0).sqrt();
  EXPECT_LT((fit.spread - spread).abs().max().item<float>(), 2e-2);
  const torch::Tensor image = torch::matmul(covariance, fit.normal.unsqueeze(2)).squeeze(2);
  const torch::Tensor error =
      (image - fit.normal * fit.spread.select(1, 0).square().unsqueeze(1)).norm(2, 1);
  EXPECT_LT((error / fit.spread.select(1, 2).square()).max().item<float>(), 1e-3);
}
}  // namespace
}  // namespace dyslam
