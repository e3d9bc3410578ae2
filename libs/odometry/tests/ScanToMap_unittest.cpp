// SPDX-License-Identifier: BSD-3-Clause
#include "local_map/ScanToMap.h"

#include <gtest/gtest.h>

#include <limits>

#include "TestScene.h"

namespace dyslam
{
namespace
{
class ScanToMapTest : public testing::TestWithParam<bool>
{
 protected:
  ScanToMapTest() : map_(0.5, 1, 1e6, pool_)
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
    settings_.start_loss_width = 0.4;
    settings_.max_iterations = 40;
  }

  ThreadPool pool_{2};
  test::StreetScene scene_;
  SurfacePyramid map_;
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
    EXPECT_TRUE(result.converged);
    EXPECT_GT(result.inlier_share, 0.5);
    EXPECT_GE(result.inlier_ratio, result.inlier_share);
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

TEST_P(ScanToMapTest, AStepThatIsNotFiniteIsReported)
{
  ScanToMap registration(pool_);
  EXPECT_TRUE(registration.align(scan_, shapes_, map_, Pose::Identity(), T_, settings_).finite);
  settings_.prior_information.setConstant(std::numeric_limits<double>::quiet_NaN());
  const ScanToMapResult result =
      registration.align(scan_, shapes_, map_, Pose::Identity(), T_, settings_);
  EXPECT_FALSE(result.finite);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.T.matrix(), T_.matrix());
}

TEST_P(ScanToMapTest, LevelGroundCountsWithinItsShare)
{
  ScanToMap registration(pool_);
  const auto heightInformation = [&](const RawPoints& scan, double share)
  {
    settings_.max_ground_weight_ratio = share;
    return registration.align(scan, shapes_, map_, Pose::Identity(), T_, settings_)
        .information(2, 2);
  };
  // Its weight is below that of all walls, but at least a fifth of its own.
  const double full = heightInformation(scan_, 1e9);
  const double half = heightInformation(scan_, 0.5);
  const double least = heightInformation(scan_, 1e-3);
  EXPECT_LE(half, full);
  EXPECT_LT(least, half);
  EXPECT_LT(least, 0.8 * full);
  EXPECT_GT(least, 0.15 * full);

  settings_.max_ground_weight_ratio = 0.1;
  Vector6 off;
  off << 0.2, 0.1, -0.1, 0.005, 0.005, -0.01;
  const ScanToMapResult found =
      registration.align(scan_, shapes_, map_, Pose::Identity(), T_ * expSE3(off), settings_);
  EXPECT_LT((T_.inverse() * found.T).translation().norm(), 0.02);
}

/** The ground is seen at a grazing angle by a lidar on it, and from above by another one. */
TEST_P(ScanToMapTest, TheAngleOfIncidenceIsThatOfThePointsOwnLidar)
{
  ScanToMap registration(pool_);
  settings_.min_incidence = 0.5;
  settings_.lidars = {{0, 0, -1.6F}, {0, 0, 100}};
  const auto heightInformation = [&](std::uint8_t lidar)
  {
    scan_.lidar.assign(scan_.size(), lidar);
    return registration.align(scan_, shapes_, map_, Pose::Identity(), T_, settings_)
        .information(2, 2);
  };
  EXPECT_GT(heightInformation(1), 2 * heightInformation(0));
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         ScanToMapTest,
                         testing::Bool(),
                         [](const testing::TestParamInfo<bool>& test_info)
                         { return test_info.param ? "gicp" : "point_to_plane"; });
}  // namespace
}  // namespace dyslam
