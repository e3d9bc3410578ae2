// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/RigidFlow.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace
{
using dyslam::fitRigidFlow;
using dyslam::PlanarMotion;

struct Field
{
  std::vector<Eigen::Vector2f> positions;
  std::vector<Eigen::Vector2f> flow;
  std::vector<float> weights;
};

PlanarMotion someMotion()
{
  PlanarMotion m;
  m.translation = {-1.3, 0.2};
  m.yaw = 0.04;
  return m;
}

Field staticField(const PlanarMotion& motion, int count, float noise, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-50, 50);
  std::normal_distribution<float> error(0, 1);
  Field f;
  for (int i = 0; i < count; ++i)
  {
    f.positions.emplace_back(place(random), place(random));
    f.flow.push_back(motion.flowAt(f.positions.back()) +
                     noise * Eigen::Vector2f(error(random), error(random)));
    f.weights.push_back(1);
  }
  return f;
}

TEST(RigidFlow, RecoversAnExactMotion)
{
  const auto motion = someMotion();
  const auto f = staticField(motion, 50, 0, 1);
  const auto fit = fitRigidFlow(f.positions, f.flow, f.weights);
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.motion.yaw, motion.yaw, 1e-5);
  EXPECT_LT((fit.motion.translation - motion.translation).norm(), 1e-4);
}

TEST(RigidFlow, MovingObjectsDoNotBiasTheFit)
{
  const auto motion = someMotion();
  auto f = staticField(motion, 300, 0.05F, 2);
  // 40 % of the field follow one moving object, such as a queue of traffic.
  for (std::size_t i = 0; i < 120; ++i)
  {
    f.flow[i] += Eigen::Vector2f(1.1F, 0.1F);
  }
  const auto fit = fitRigidFlow(f.positions, f.flow, f.weights);
  EXPECT_NEAR(fit.motion.yaw, motion.yaw, 1e-3);
  EXPECT_LT((fit.motion.translation - motion.translation).norm(), 0.03);
  EXPECT_LT(fit.inlier[0], 0.05F);
  EXPECT_GT(fit.inlier[200], 0.3F);
}

TEST(RigidFlow, MinimisesTheSquaredError)
{
  const auto f = staticField(someMotion(), 40, 0.3F, 3);
  // With a wide loss the fit is weighted least squares.
  const auto fit = fitRigidFlow(f.positions, f.flow, f.weights, 1e4, 1e4);
  const auto cost = [&](const PlanarMotion& m)
  {
    double sum = 0;
    for (std::size_t i = 0; i < f.positions.size(); ++i)
    {
      sum += (m.flowAt(f.positions[i]) - f.flow[i]).squaredNorm();
    }
    return sum;
  };
  const double best = cost(fit.motion);
  for (const double step : {-1e-3, 1e-3})
  {
    auto other = fit.motion;
    other.yaw += step;
    EXPECT_GT(cost(other), best);
    for (int axis = 0; axis < 2; ++axis)
    {
      other = fit.motion;
      other.translation[axis] += 20 * step;
      EXPECT_GT(cost(other), best);
    }
  }
}

TEST(RigidFlow, IgnoresVectorsOfZeroWeight)
{
  auto f = staticField(someMotion(), 60, 0, 4);
  for (std::size_t i = 0; i < 40; ++i)
  {
    f.flow[i] = Eigen::Vector2f(3, 3);
    f.weights[i] = 0;
  }
  const auto fit = fitRigidFlow(f.positions, f.flow, f.weights);
  EXPECT_LT((fit.motion.translation - someMotion().translation).norm(), 1e-3);
}

TEST(RigidFlow, DoesNotConvergeWithTooFewVectors)
{
  EXPECT_FALSE(fitRigidFlow({}, {}, {}).converged);
  EXPECT_FALSE(fitRigidFlow({{1, 1}}, {{0, 0}}, {1}).converged);
  const std::vector<Eigen::Vector2f> three{{0, 0}, {1, 0}, {0, 1}};
  EXPECT_FALSE(fitRigidFlow(three, three, {0, 0, 0}).converged);
}

TEST(RigidFlow, StaysAtTheStartWithTooFewVectors)
{
  const auto start = someMotion();
  const auto fit = fitRigidFlow({{1, 1}, {5, 2}}, {{0, 0}, {0, 0}}, {1, 1}, 0.15, 2, &start);
  EXPECT_FALSE(fit.converged);
  EXPECT_EQ(fit.motion.translation, start.translation);
  EXPECT_EQ(fit.motion.yaw, start.yaw);
}

TEST(RigidFlow, PlanarMotionRoundTripsThroughPose)
{
  const auto m = PlanarMotion::fromPose(someMotion().pose());
  EXPECT_NEAR(m.yaw, someMotion().yaw, 1e-12);
  EXPECT_LT((m.translation - someMotion().translation).norm(), 1e-12);
  const Eigen::Vector3d moved = someMotion().pose() * Eigen::Vector3d(3, 4, 5);
  EXPECT_LT((moved.head<2>() - someMotion() * Eigen::Vector2d(3, 4)).norm(), 1e-12);
}
}  // namespace
