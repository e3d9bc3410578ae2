// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Motion.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

namespace dyslam
{
namespace
{
MotionPrior priorOf(const Pose& T, double sigma, double sigma_angle)
{
  MotionPrior prior;
  prior.T_previous_current = T;
  prior.information = informationFromSigmas(sigma, sigma_angle);
  return prior;
}

TEST(MotionPrior, FusedMeanIsWeightedByInformation)
{
  MotionPrior prior = priorOf(Pose::Identity(), 0.2, 0.01);
  prior.fuse(poseFromYpr(1, 0, 0, 0, 0, 0), informationFromSigmas(0.1, 0.01));
  EXPECT_NEAR(prior.T_previous_current.translation().x(), 0.8, 1e-12);
  EXPECT_NEAR(prior.information(0, 0), 1 / 0.04 + 1 / 0.01, 1e-9);
}

TEST(MotionPrior, AMeasurementWithoutInformationChangesNothing)
{
  MotionPrior prior = priorOf(poseFromYpr(1, 2, 3, 0.1, 0, 0), 0.2, 0.01);
  const MotionPrior before = prior;
  prior.fuse(Pose::Identity(), Matrix6::Zero());
  EXPECT_TRUE(prior.T_previous_current.isApprox(before.T_previous_current, 1e-12));
  EXPECT_EQ(prior.information, before.information);
}

TEST(MotionPrior, DirectionsThatAreNotMeasuredStay)
{
  MotionPrior prior = priorOf(Pose::Identity(), 0.2, 0.01);
  Matrix6 planar = informationFromSigmas(0.001, 0.0001);
  planar(2, 2) = 0;
  prior.fuse(poseFromYpr(1, 0, 1, 0, 0, 0), planar);
  EXPECT_NEAR(prior.T_previous_current.translation().x(), 1, 1e-3);
  EXPECT_NEAR(prior.T_previous_current.translation().z(), 0, 1e-3);
}

TEST(MotionPrior, MahalanobisDistanceCountsBothCovariances)
{
  const MotionPrior prior = priorOf(Pose::Identity(), 0.3, 0.01);
  EXPECT_NEAR(prior.mahalanobisDistance(poseFromYpr(1, 0, 0, 0, 0, 0), 0.4, 0.01), 2, 1e-9);
  EXPECT_NEAR(prior.mahalanobisDistance(poseFromYpr(0, 0, 0, 0.03, 0, 0), 0.4, 0.02),
              0.03 / std::sqrt(0.0005), 1e-6);
}

TEST(InformationFromSigmas, IsTheInverseOfTheSquares)
{
  const Matrix6 covariance = informationFromSigmas(0.5, 0.02).inverse();
  EXPECT_NEAR(covariance(1, 1), 0.25, 1e-12);
  EXPECT_NEAR(covariance(5, 5), 0.0004, 1e-12);
  EXPECT_EQ(covariance(0, 4), 0);
}
}  // namespace
}  // namespace dyslam
