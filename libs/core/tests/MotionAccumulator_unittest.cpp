// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/MotionAccumulator.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

namespace dyslam
{
namespace
{
Vector6 draw(const Matrix6& covariance, std::mt19937& rng)
{
  std::normal_distribution<double> unit;
  Vector6 x;
  for (double& value : x)
  {
    value = unit(rng);
  }
  return covariance.llt().matrixL() * x;
}

Matrix6 diagonal(double translation, double rotation)
{
  return informationFromSigmas(1 / translation, 1 / rotation);
}

TEST(MotionAccumulator, WithoutPoseNoiseCovariancesAddUp)
{
  const Pose step = poseFromYpr(1, 0.1, 0, 0.2, 0, 0.05);
  const Matrix6 own = diagonal(0.02, 0.003);
  MotionAccumulator sum;
  sum.add(step, own, Matrix6::Zero());
  EXPECT_TRUE(sum.covariance().isApprox(own, 1e-12));
  sum.add(step, own, Matrix6::Zero());
  const Matrix6 A = adjointSE3(step.inverse());
  EXPECT_TRUE(sum.covariance().isApprox(A * own * A.transpose() + own, 1e-12));
  EXPECT_TRUE(sum.motion().isApprox(step * step, 1e-12));
}

// Draws trajectories with both kinds of error and compares their spread with the covariance.
TEST(MotionAccumulator, CovarianceIsThatOfSimulatedMotions)
{
  const Pose step = poseFromYpr(0.6, 0, 0.02, 0.1, 0.01, 0);
  const Matrix6 noise = diagonal(0.02, 0.002);
  const Matrix6 drift = diagonal(0.005, 0.0005);
  const Matrix6 A = adjointSE3(step.inverse());
  const Matrix6 own = A * noise * A.transpose() + noise + drift;
  MotionAccumulator sum;
  sum.add(step, own, noise);
  sum.restart();
  EXPECT_TRUE(sum.covariance().isZero(0));
  constexpr int steps = 5;
  for (int i = 0; i < steps; ++i)
  {
    sum.add(step, own, noise);
  }

  std::mt19937 rng(3);
  constexpr int runs = 4000;
  Matrix6 spread = Matrix6::Zero();
  for (int run = 0; run < runs; ++run)
  {
    Pose found = expSE3(draw(noise, rng)).inverse();
    for (int i = 0; i < steps; ++i)
    {
      found = found * step * expSE3(draw(drift, rng));
    }
    found = found * expSE3(draw(noise, rng));
    const Vector6 error = logSE3(sum.motion().inverse() * found);
    spread += error * error.transpose() / runs;
  }
  // Whitened, the spread is the identity up to the sampling error of 4000 runs.
  const Eigen::LLT<Matrix6> root(sum.covariance());
  const Matrix6 whitened = root.matrixL().solve(Matrix6(root.matrixL().solve(spread).transpose()));
  EXPECT_LT((whitened - Matrix6::Identity()).cwiseAbs().maxCoeff(), 0.1) << whitened;
}

TEST(MotionAccumulator, StaysPositiveWhereAMotionClaimsLessThanItsNoise)
{
  MotionAccumulator sum;
  sum.add(Pose::Identity(), diagonal(0.001, 0.0001), diagonal(0.02, 0.002));
  sum.restart();
  sum.add(Pose::Identity(), diagonal(0.001, 0.0001), diagonal(0.02, 0.002));
  EXPECT_EQ(sum.covariance().llt().info(), Eigen::Success);
}
}  // namespace
}  // namespace dyslam
