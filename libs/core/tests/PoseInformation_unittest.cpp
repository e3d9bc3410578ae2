// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PoseInformation.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

namespace dyslam
{
namespace
{
Vector6 coordinates(const Pose& pose)
{
  Vector6 c;
  c << pose.translation(), yawPitchRoll(pose);
  return c;
}

Matrix6 randomInformation(std::mt19937& rng)
{
  std::normal_distribution<double> n;
  Matrix6 a;
  for (int i = 0; i < 36; ++i)
  {
    a(i) = n(rng);
  }
  return a * a.transpose() + 0.1 * Matrix6::Identity();
}

TEST(PoseInformation, YprJacobianMatchesNumericalDerivative)
{
  const double step = 1e-6;
  for (const double pitch : {-1.5, -0.7, 0.0, 0.3, 1.2, 1.55})
  {
    const Pose mean = poseFromYpr(1, -2, 3, 0.7, pitch, -0.4);
    Matrix6 numeric;
    for (int i = 0; i < 6; ++i)
    {
      const Vector6 d = step * Vector6::Unit(i);
      numeric.col(i) =
          (coordinates(mean * expSE3(d)) - coordinates(mean * expSE3(-d))) / (2 * step);
    }
    const double scale = 1 / std::cos(pitch);
    EXPECT_LT((yprFromTangentJacobian(mean) - numeric).norm(), 1e-6 * scale * scale * scale)
        << pitch;
    EXPECT_LT(
        (yprFromTangentJacobian(mean) * tangentFromYprJacobian(mean) - Matrix6::Identity()).norm(),
        1e-9);
  }
}

TEST(PoseInformation, QuaternionScaleMatchesNumericalDerivative)
{
  // e = [t, vector part] of exp(x): the information of x is J' I J with J = de/dx.
  const double step = 1e-5;
  Matrix6 jacobian;
  for (int i = 0; i < 6; ++i)
  {
    const Pose plus = expSE3(step * Vector6::Unit(i));
    jacobian.col(i) << plus.translation() / step, Eigen::Quaterniond(plus.linear()).vec() / step;
  }
  std::mt19937 rng(1);
  const Matrix6 information = randomInformation(rng);
  const Matrix6 expected = jacobian.transpose() * information * jacobian;
  EXPECT_TRUE(informationFromQuaternion(information).isApprox(expected, 1e-6));
}

TEST(PoseInformation, ThereAndBackGivesTheSameMatrix)
{
  std::mt19937 rng(2);
  for (const double pitch : {0.0, 0.5, -1.2, M_PI / 2, -M_PI / 2, M_PI / 2 - 1e-5, M_PI / 2 - 2e-3})
  {
    for (int i = 0; i < 10; ++i)
    {
      const Pose mean = poseFromYpr(1, 2, 3, 0.3 * i - 1.5, pitch, 0.2 * i);
      const Matrix6 information = randomInformation(rng);
      const Matrix6 ypr = informationToYpr(mean, information);
      EXPECT_TRUE(informationFromYpr(mean, ypr).isApprox(information, 1e-7)) << pitch;
      EXPECT_TRUE(informationFromQuaternion(informationToQuaternion(information))
                      .isApprox(information, 1e-12));
      EXPECT_EQ(ypr, Matrix6(ypr.transpose()));
    }
  }
}

TEST(PoseInformation, GradientOfTheChiSquaredIsTheSameInBothCoordinates)
{
  // The two quadratic forms agree to first order for small deviations.
  std::mt19937 rng(3);
  const Pose mean = poseFromYpr(4, 5, 6, 2.5, 0.8, -1.9);
  const Matrix6 information = randomInformation(rng);
  const Vector6 x = 1e-5 * Vector6(1, -2, 3, -1, 2, 1);
  const Vector6 difference = coordinates(mean * expSE3(x)) - coordinates(mean);
  const double ours = x.dot(information * x);
  const double mrpt = difference.dot(informationToYpr(mean, information) * difference);
  EXPECT_NEAR(mrpt / ours, 1, 1e-4);
}
}  // namespace
}  // namespace dyslam
