// SPDX-License-Identifier: BSD-3-Clause
#include "../src/exports/OdometryCovariances.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstddef>
#include <random>
#include <vector>

namespace dyslam
{
namespace
{
constexpr std::size_t curve_scans = 6;
const Pose T_map_odom = poseFromYpr(5, -3, 1, 2, 0.2, -0.1);

Matrix6 someCovariance()
{
  Matrix6 root = Matrix6::Identity();
  root(1, 0) = 0.5;
  root(3, 2) = -0.4;
  root(5, 1) = 0.7;
  Vector6 sigmas;
  sigmas << 0.02, 0.01, 0.03, 0.004, 0.003, 0.006;
  return sigmas.asDiagonal() * root * root.transpose() * sigmas.asDiagonal();
}

/** A curve by odometry, with independent errors of its motions. */
struct Curve
{
  Curve()
  {
    const Pose step = poseFromYpr(0.9, 0.05, 0.02, 0.2, 0.03, -0.02);
    for (std::size_t i = 0; i < curve_scans; ++i)
    {
      const double stamp = 100 + 0.1 * static_cast<double>(i);
      odometry.push_back(stamp, i == 0 ? Pose::Identity() : odometry[i - 1].pose * step);
      trajectory.push_back(stamp, T_map_odom * odometry[i].pose);
      MotionCovariance motion;
      motion.stamp = stamp;
      motion.covariance = i == 0 ? Matrix6(Matrix6::Zero()) : someCovariance();
      motions.push_back(motion);
    }
  }

  Trajectory odometry;
  Trajectory trajectory;
  std::vector<MotionCovariance> motions;
};

/** The spread of the last pose of simulated odometry, as messages have it: of the position in the
 * axes of the map, and of the rotation about these. */
TEST(OdometryCovariances, OfThePosesAreThoseOfSimulatedOdometry)
{
  const Curve curve;
  std::mt19937 rng(5);
  std::normal_distribution<double> unit;
  const Matrix6 root = someCovariance().llt().matrixL();
  const Pose expected = curve.trajectory[curve_scans - 1].pose;
  Matrix6 spread = Matrix6::Zero();
  constexpr int draws = 20000;
  for (int n = 0; n < draws; ++n)
  {
    Pose pose = curve.trajectory[0].pose;
    for (std::size_t i = 1; i < curve_scans; ++i)
    {
      Vector6 error;
      for (double& value : error)
      {
        value = unit(rng);
      }
      pose = pose * curve.odometry[i - 1].pose.inverse() * curve.odometry[i].pose *
             expSE3(root * error);
    }
    Pose turn = Pose::Identity();
    turn.linear() = pose.linear() * expected.linear().transpose();
    Vector6 error;
    error << pose.translation() - expected.translation(), logSE3(turn).tail<3>();
    spread += error * error.transpose() / draws;
  }
  const OdometryCovariances covariances(curve.trajectory, curve.odometry, curve.motions);
  const auto last = covariances.ofPose(curve.trajectory[curve_scans - 1].stamp);
  ASSERT_TRUE(last.has_value());
  const Matrix6 message = inParentAxes(*last, expected);
  const Vector6 sigmas = spread.diagonal().cwiseSqrt();
  for (int i = 0; i < 6; ++i)
  {
    for (int j = 0; j < 6; ++j)
    {
      EXPECT_NEAR(spread(i, j), message(i, j), 0.05 * sigmas[i] * sigmas[j]) << i << " " << j;
    }
  }
  EXPECT_TRUE(covariances.ofPose(100).value().isZero(0)) << "the first one defines the map";
}

TEST(OdometryCovariances, ArePartsOfTheRunsMotions)
{
  const Curve curve;
  const OdometryCovariances covariances(curve.trajectory, curve.odometry, curve.motions);
  EXPECT_EQ(someCovariance(), covariances.ofMotion(100.1, 100.2).value());
  EXPECT_FALSE(covariances.ofMotion(100.1, 100.3)) << "two motions";
  EXPECT_FALSE(covariances.ofMotion(100.1, 100.15));
  EXPECT_FALSE(covariances.ofMotion(99.9, 100));
  EXPECT_FALSE(covariances.ofPose(100.05)) << "between two scans";
  EXPECT_FALSE(covariances.ofPose(101));
}

TEST(OdometryCovariances, OfCorrectedPosesAreNotKnown)
{
  const Curve curve;
  Trajectory corrected;
  for (std::size_t i = 0; i < curve_scans; ++i)
  {
    const Pose loop = poseFromYpr(0, 1e-3 * static_cast<double>(i), 0, 0, 0, 0);
    corrected.push_back(curve.trajectory[i].stamp, loop * curve.trajectory[i].pose);
  }
  const OdometryCovariances of_corrected(corrected, curve.odometry, curve.motions);
  EXPECT_FALSE(of_corrected.ofPose(100.2));
  EXPECT_EQ(someCovariance(), of_corrected.ofMotion(100.1, 100.2).value());

  EXPECT_FALSE(OdometryCovariances(curve.trajectory, {}, curve.motions).ofPose(100.2));
  std::vector<MotionCovariance> fewer = curve.motions;
  fewer.pop_back();
  EXPECT_FALSE(OdometryCovariances(curve.trajectory, curve.odometry, fewer).ofPose(100.2));
  std::vector<MotionCovariance> shifted = curve.motions;
  shifted[2].stamp += 0.02;
  EXPECT_FALSE(OdometryCovariances(curve.trajectory, curve.odometry, shifted).ofPose(100.1));
  EXPECT_FALSE(OdometryCovariances({}, {}, {}).ofPose(100));
}
}  // namespace
}  // namespace dyslam
