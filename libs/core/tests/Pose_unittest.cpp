// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FastAngle.h>
#include <dyslam/core/Pose.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace dyslam
{
namespace
{
Vector6 randomTangent(std::mt19937& rng, double translation, double rotation)
{
  std::uniform_real_distribution<double> u(-1, 1);
  Vector6 x;
  x << u(rng), u(rng), u(rng), u(rng), u(rng), u(rng);
  x.head<3>() *= translation;
  x.tail<3>() *= rotation;
  return x;
}

TEST(Pose, LogarithmInvertsExponential)
{
  std::mt19937 rng(1);
  for (const double rotation : {0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 1.7})
  {
    for (int i = 0; i < 20; ++i)
    {
      const Vector6 x = randomTangent(rng, 10, rotation);
      EXPECT_LT((logSE3(expSE3(x)) - x).norm(), 1e-8) << x.transpose();
    }
  }
}

TEST(Pose, LogarithmNearHalfTurnGivesTheSamePose)
{
  for (const double angle : {3.14, 3.14159, 3.14159265358979})
  {
    Vector6 x;
    x << 1, 2, 3, 0, 0, angle;
    EXPECT_TRUE(expSE3(logSE3(expSE3(x))).isApprox(expSE3(x), 1e-7));
  }
}

TEST(Pose, AdjointMovesTangentsAcross)
{
  std::mt19937 rng(2);
  const Pose T = expSE3(randomTangent(rng, 5, 1));
  const Vector6 x = randomTangent(rng, 1, 1);
  EXPECT_TRUE((T * expSE3(x) * T.inverse()).isApprox(expSE3(adjointSE3(T) * x), 1e-9));
}

TEST(Pose, RightJacobianInverseMatchesNumericalDerivative)
{
  std::mt19937 rng(3);
  for (const double rotation : {1e-7, 5e-3, 0.02, 0.5, 1.5})
  {
    const Vector6 x = randomTangent(rng, 3, rotation);
    Matrix6 numeric;
    const double step = 1e-6;
    for (int i = 0; i < 6; ++i)
    {
      Vector6 d = Vector6::Zero();
      d(i) = step;
      numeric.col(i) =
          (logSE3(expSE3(x) * expSE3(d)) - logSE3(expSE3(x) * expSE3(-d))) / (2 * step);
    }
    EXPECT_LT((numeric - rightJacobianInverseSE3(x)).norm(), 1e-6) << rotation;
  }
}

TEST(Pose, MotionSizeCountsATurnAtItsLever)
{
  Vector6 motion;
  motion << 3, 0, 4, 0, 0.2, 0;
  EXPECT_DOUBLE_EQ(motionSize(motion), 7);
  EXPECT_DOUBLE_EQ(motionSize(motion, 5), 6);
  EXPECT_EQ(motionSize(Vector6::Zero()), 0);
}

TEST(Pose, YawPitchRollRoundTrip)
{
  const Pose pose = poseFromYpr(1, 2, 3, 0.5, -0.3, 2.0);
  EXPECT_TRUE(yawPitchRoll(pose).isApprox(Eigen::Vector3d(0.5, -0.3, 2.0), 1e-12));
}

TEST(Pose, TextIsThatOfOptions)
{
  Pose pose = Pose::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() << 1, -2.5, -0.0;
  EXPECT_EQ("1 -2.5 0 90 0 0", poseText(pose));
  // What products of rotations leave of a zero is not written.
  EXPECT_EQ("0.8 0.1 1.7 180 5.729578 0",
            poseText(poseFromYpr(0.8, 0.1, 1.7, 3.14159265, 0.1, -3e-18)));
}

TEST(Pose, IsReadFromItsText)
{
  const Pose pose = poseFromYpr(1, -2.5, 0.25, 0.5, -0.1, 0.02);
  ASSERT_TRUE(poseFromText(poseText(pose)));
  EXPECT_TRUE(poseFromText(poseText(pose))->isApprox(pose, 1e-6));
  EXPECT_TRUE(poseFromText("1,-2.5, 0 90 0 0")->isApprox(poseFromYpr(1, -2.5, 0, M_PI / 2, 0, 0)));
  for (const char* other : {"", "1 2 3 4 5", "1 2 3 4 5 6 7", "1 2 3 4 5 six", "here"})
  {
    EXPECT_FALSE(poseFromText(other)) << other;
  }
}

TEST(Pose, InterpolationKeepsEndsAndMiddle)
{
  const Pose a = poseFromYpr(0, 0, 0, 0, 0, 0);
  const Pose b = poseFromYpr(2, 0, 0, 0, 0, 0.4);
  EXPECT_TRUE(interpolate(a, b, 0).isApprox(a));
  EXPECT_TRUE(interpolate(a, b, 1).isApprox(b));
  EXPECT_NEAR(interpolate(a, b, 0.5).translation().x(), 1, 1e-12);
  EXPECT_NEAR(rotationAngle(interpolate(a, b, 0.5)), 0.2, 1e-12);
}

TEST(Pose, OrthonormalisedRepairsRoundedRotations)
{
  Pose pose = poseFromYpr(1, 2, 3, 1, 0.2, 0.1);
  pose.linear() *= 1.0003;
  const Pose repaired = orthonormalised(pose);
  EXPECT_LT(
      (repaired.linear() * repaired.linear().transpose() - Eigen::Matrix3d::Identity()).norm(),
      1e-12);
  EXPECT_TRUE(repaired.isApprox(poseFromYpr(1, 2, 3, 1, 0.2, 0.1), 1e-9));
}

TEST(FastAngle, WithinItsBoundOfAtan2)
{
  for (int k = -1000; k <= 1000; ++k)
  {
    const double angle = 3.14159 * k / 1000;
    const auto y = static_cast<float>(3 * std::sin(angle));
    const auto x = static_cast<float>(3 * std::cos(angle));
    EXPECT_NEAR(static_cast<double>(turnsOf(y, x)) * 2 * M_PI, angle, 1.3e-5);
  }
  EXPECT_EQ(turnsOf(0, 0), 0);
}

TEST(Pose, PosesOfAMountedSensor)
{
  // The camera looks along the lidar's x; it is 0.3 m ahead of it and 0.1 m below.
  Pose T_cam_velo = Pose::Identity();
  T_cam_velo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  T_cam_velo.translation() = Eigen::Vector3d(0, -0.1, -0.3);
  // Driving 2 m ahead and turning left: along z and about -y for the camera.
  const Pose lidar = poseFromYpr(2, 0.5, 0, 0.3, 0, 0);
  const auto camera = posesOfMountedSensor({Pose::Identity(), lidar}, T_cam_velo.inverse());
  EXPECT_TRUE(camera[0].isApprox(Pose::Identity(), 1e-12));
  EXPECT_TRUE(camera[1].linear().isApprox(expSO3(Eigen::Vector3d(0, -0.3, 0)), 1e-12));
  // Where the camera is after the motion, by hand.
  const Eigen::Vector3d camera_in_lidar = T_cam_velo.inverse().translation();
  const Eigen::Vector3d moved = T_cam_velo * (lidar * camera_in_lidar);
  EXPECT_TRUE(camera[1].translation().isApprox(moved, 1e-12));
  EXPECT_TRUE(posesOfMountedSensor(camera, T_cam_velo)[1].isApprox(lidar, 1e-12));
  EXPECT_TRUE(posesOfMountedSensor({}, T_cam_velo).empty());
}

TEST(Pose, SymmetricPart)
{
  Matrix6 M = Matrix6::Identity();
  M(0, 5) = 3;
  M(5, 0) = 1;
  Matrix6 expected = Matrix6::Identity();
  expected(0, 5) = expected(5, 0) = 2;
  EXPECT_EQ(symmetricPart(M), expected);
}
}  // namespace
}  // namespace dyslam
