// SPDX-License-Identifier: BSD-3-Clause
#include "ScanToMap.h"

#include <dyslam/odometry/LocalMapRefinement.h>
#include <gtest/gtest.h>

#include <random>

#include "RowAlignment.h"
#include "TestScene.h"

namespace dyslam
{
namespace
{
TEST(RowSums, GradientAgreesWithNumericDerivative)
{
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto vector = [&]()
  { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  for (int round = 0; round < 20; ++round)
  {
    Vector6 tangent;
    tangent << vector(), vector();
    const Pose T = expSE3(tangent);
    const Eigen::Vector3d n = vector().normalized();
    const Eigen::Vector3d p = 5 * vector();
    const Eigen::Vector3d q = vector();
    const auto residual = [&](const Pose& at) { return n.dot(at * p - q); };
    RowSums sums;
    sums.addRow(n, p, T.linear(), residual(T), 1);
    for (int k = 0; k < 6; ++k)
    {
      constexpr double h = 1e-6;
      const Vector6 d = h * Vector6::Unit(k);
      const double slope = (residual(T * expSE3(d)) - residual(T * expSE3(-d))) / (2 * h);
      EXPECT_NEAR(sums.g[k], slope * residual(T), 1e-5 * (1 + std::fabs(sums.g[k])));
      EXPECT_NEAR(sums.H(k, k), slope * slope, 1e-5 * (1 + sums.H(k, k)));
    }
  }
}

class ScanToMapTest : public testing::TestWithParam<bool>
{
 protected:
  ScanToMapTest() : map_(0.5, 1e6, pool_)
  {
    map_.add(scene_.frame(Pose::Identity(), 0.01, 1).cloud.points, {}, Pose::Identity());
    const Frame frame = scene_.frame(T_, 0.01, 2);
    SurfaceMap own(0.5, 1e6, pool_);
    own.add(frame.cloud.points, {}, Pose::Identity());
    const VoxelSample sample = voxelDownsample(frame.cloud.points, 0.5);
    scan_.points = sample.points;
    for (const Eigen::Vector3f& p : scan_.points)
    {
      shapes_.push_back(own.surfaceAt(p, VoxelCell()).covariance);
    }
    settings_.distributions = GetParam();
    settings_.start_kernel = 0.4;
    settings_.max_iterations = 40;
  }

  ThreadPool pool_{2};
  test::StreetScene scene_;
  SurfaceMap map_;
  Pose T_ = poseFromYpr(0.4, -0.1, 0.02, 0.02, 0.004, -0.003);
  RawPoints scan_;
  std::vector<Eigen::Matrix3f> shapes_;
  ScanToMapSettings settings_;
};

TEST_P(ScanToMapTest, FindsThePoseFromAround)
{
  for (const double sign : {-1.0, 1.0})
  {
    Vector6 off;
    off << 0.2 * sign, 0.1, -0.1 * sign, 0.005, 0.005 * sign, -0.01;
    ScanToMap registration(pool_);
    const ScanToMapResult result =
        registration.align(scan_, shapes_, map_, Pose::Identity(), T_ * expSE3(off), settings_);
    const Pose error = T_.inverse() * result.T;
    EXPECT_TRUE(result.settled);
    EXPECT_GT(result.inlier_share, 0.5);
    EXPECT_LT(error.translation().norm(), 0.02);
    EXPECT_LT(rotationAngle(error), 0.001);
  }
}

TEST_P(ScanToMapTest, AStrongGuessIsKept)
{
  settings_.prior_information = 1e12 * Matrix6::Identity();
  ScanToMap registration(pool_);
  const ScanToMapResult result =
      registration.align(scan_, shapes_, map_, Pose::Identity(), Pose::Identity(), settings_);
  EXPECT_LT(result.T.translation().norm(), 1e-3);
}

TEST_P(ScanToMapTest, LevelGroundCountsWithinItsShare)
{
  ScanToMap registration(pool_);
  const auto heightInformation = [&](const RawPoints& scan, double share)
  {
    settings_.level_share = share;
    return registration.align(scan, shapes_, map_, Pose::Identity(), T_, settings_)
        .information(2, 2);
  };
  // It counts less than all the walls, but a fifth is always left.
  const double full = heightInformation(scan_, 1e9);
  const double half = heightInformation(scan_, 0.5);
  const double least = heightInformation(scan_, 1e-3);
  EXPECT_LE(half, full);
  EXPECT_LT(least, half);
  EXPECT_LT(least, 0.8 * full);
  EXPECT_GT(least, 0.15 * full);

  settings_.level_share = 0.1;
  Vector6 off;
  off << 0.2, 0.1, -0.1, 0.005, 0.005, -0.01;
  const ScanToMapResult found =
      registration.align(scan_, shapes_, map_, Pose::Identity(), T_ * expSE3(off), settings_);
  EXPECT_LT((T_.inverse() * found.T).translation().norm(), 0.02);
}

TEST(PosePrior, JoinsMeasurementsByTheirInformation)
{
  PosePrior prior{Pose::Identity(), Matrix6::Identity()};
  prior.join(poseFromYpr(0.4, 0, 0, 0, 0, 0), 3 * Matrix6::Identity());
  EXPECT_NEAR(prior.T_odom_vehicle.translation().x(), 0.3, 1e-12);
  EXPECT_NEAR(prior.information(0, 0), 4, 1e-12);
  // What a measurement does not see stays as it was.
  Matrix6 ahead = Matrix6::Zero();
  ahead(0, 0) = 1e6;
  prior.join(poseFromYpr(1, 5, 0, 0, 0, 0), ahead);
  EXPECT_NEAR(prior.T_odom_vehicle.translation().x(), 1, 1e-4);
  EXPECT_NEAR(prior.T_odom_vehicle.translation().y(), 0, 1e-12);
}

TEST(PosePrior, CountsDeviationsOfBoth)
{
  Vector6 information;
  information << 400, 400, 400, 1e4, 1e4, 1e4;
  const Pose T = poseFromYpr(3, 1, 0, 0.5, 0, 0);
  const PosePrior prior{T, information.asDiagonal()};
  EXPECT_NEAR(prior.deviationsTo(T, 0.1, 0.02), 0, 1e-9);
  const double both = std::hypot(0.05, 0.1);
  EXPECT_NEAR(prior.deviationsTo(T * poseFromYpr(3 * both, 0, 0, 0, 0, 0), 0.1, 0.02), 3, 1e-9);
  const double turn = std::hypot(0.01, 0.02);
  EXPECT_NEAR(prior.deviationsTo(T * poseFromYpr(0, 0, 0, 2 * turn, 0, 0), 0.1, 0.02), 2, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         ScanToMapTest,
                         testing::Bool(),
                         [](const testing::TestParamInfo<bool>& test_info)
                         { return test_info.param ? "gicp" : "point_to_plane"; });
}  // namespace
}  // namespace dyslam
