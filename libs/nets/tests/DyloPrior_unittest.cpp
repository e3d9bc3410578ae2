// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloPrior.h>
#include <gtest/gtest.h>

#include <random>

namespace dyslam
{
namespace
{
struct DyloPriorTest : ::testing::Test
{
  DyloPriorTest()
  {
    prior.T_reference_current = poseFromYpr(2.8, 0.1, -0.05, 0.03, 0.01, -0.02);
    T = prior.T_reference_current * poseFromYpr(0.05, -0.02, 0.01, 0.002, -0.001, 0.003);
    step << 0.02, 0.01, -0.03, 0.001, 0.002, -0.001;
    prior.information = randomInformation();
    measured = randomInformation();
  }

  Matrix6 randomInformation()
  {
    Matrix6 half;
    for (double& value : half.reshaped())
    {
      value = std::normal_distribution<double>()(random);
    }
    return 1000 * (half * half.transpose() + 0.1 * Matrix6::Identity());
  }

  [[nodiscard]] double cost(const Vector6& x) const
  {
    const Vector6 off = x - step;
    const Vector6 from_prior = logSE3(prior.T_reference_current.inverse() * expSE3(x) * T);
    return off.dot(measured * off) + from_prior.dot(prior.information * from_prior);
  }

  std::mt19937 random{3};
  DyloPrior prior;
  Pose T;
  Vector6 step;
  Matrix6 measured;
};

TEST_F(DyloPriorTest, FusedStepMinimisesTheCost)
{
  const Vector6 best = fuseWithPrior(prior, T, step, measured);
  const double least = cost(best);
  EXPECT_LT(least, cost(step));
  for (int axis = 0; axis < 6; ++axis)
  {
    for (const double sign : {-1.0, 1.0})
    {
      // A tolerance small against the distance to the prior, large against the linearisation error.
      EXPECT_LT(least, cost(best + sign * 0.002 * Vector6::Unit(axis))) << axis;
    }
  }
}

TEST_F(DyloPriorTest, ReducesToEitherSideAlone)
{
  const Matrix6 none = Matrix6::Zero();
  EXPECT_TRUE(fuseWithPrior(prior, T, step, 1e9 * measured).isApprox(step, 1e-4));
  const Pose at_prior = expSE3(fuseWithPrior(prior, T, step, none)) * T;
  EXPECT_TRUE(at_prior.isApprox(prior.T_reference_current, 1e-9));
  prior.information = none;
  EXPECT_TRUE(fuseWithPrior(prior, T, step, measured).isApprox(step, 1e-9));
}

TEST(MeasurementPrecision, DependsOnPointsAndNoise)
{
  // 240 points at 24 per measurement, with 3 cm of noise in addition to the minimum of 1 cm.
  EXPECT_NEAR(measurementPrecision(0.03, 240, 24), 10 / (0.0009 + 0.0001), 1e-6);
  EXPECT_NEAR(measurementPrecision(0, 24, 24), 1e4, 1e-6);
}
}  // namespace
}  // namespace dyslam
