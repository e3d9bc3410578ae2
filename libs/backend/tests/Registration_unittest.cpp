// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/VoxelGrid.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <fstream>
#include <string>

#include "BoxWorld.h"
#include "RealData.h"
#include "loops/KeyframeRegistration.h"
#include "loops/PolarDescriptor.h"

namespace dyslam
{
namespace
{
using test::BoxWorld;

std::vector<Eigen::Vector3f> sampled(const std::vector<Eigen::Vector3f>& points, double voxel = 0.5)
{
  return voxelDownsample(points, voxel, VoxelPick::centroid).points;
}

/** KITTI's float32 x y z intensity; nothing if the file is not there. */
std::vector<Eigen::Vector3f> readBin(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::vector<Eigen::Vector3f> points;
  float p[4];
  while (file.read(reinterpret_cast<char*>(p), sizeof p))
  {
    const Eigen::Vector3f q(p[0], p[1], p[2]);
    if (q.allFinite() && !q.isZero(0) && q.norm() > 3 && q.norm() < 80)
    {
      points.push_back(q);
    }
  }
  return points;
}

TEST(KeyframeRegistration, FindsKnownMotionsThereAndBack)
{
  const BoxWorld world(1, 40, 25);
  const Pose a = poseFromYpr(0, -25, 1.7, 0.1, 0, 0);
  RegistrationTarget target(sampled(world.scan(a, 1)), {});
  for (const Pose& motion : {poseFromYpr(0, 0, 0, 0, 0, 0), poseFromYpr(1.5, 0.4, 0, 0.1, 0, 0),
                             poseFromYpr(-1, 1, 0.1, -0.15, 0.02, -0.02)})
  {
    for (const Pose& T : {motion, motion.inverse()})
    {
      const auto source = sampled(world.scan(a * T, 2));
      const auto result = target.align(source, Pose::Identity());
      EXPECT_TRUE(result.converged);
      const Pose error = T.inverse() * result.T_target_source;
      EXPECT_LT(error.translation().norm(), 0.06);
      EXPECT_LT(rotationAngle(error), 0.006);
      EXPECT_GT(result.overlap, 0.6);
      EXPECT_LT(result.rmse, 0.12);
      const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(result.information);
      EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
      EXPECT_LT(error.translation().norm(), 5 / std::sqrt(eigen.eigenvalues().minCoeff()));
    }
  }
}

TEST(KeyframeRegistration, AnotherPlaceDoesNotOverlap)
{
  const BoxWorld world(2, 40, 25);
  RegistrationTarget target(sampled(world.scan(poseFromYpr(0, -25, 1.7, 0, 0, 0), 1)), {});
  const auto other = sampled(world.scan(poseFromYpr(40, 5, 1.7, M_PI / 2, 0, 0), 2));
  const auto result = target.align(other, Pose::Identity());
  EXPECT_TRUE(!result.converged || result.overlap < 0.6) << result.overlap;
}

TEST(KeyframeRegistration, FlatGroundLeavesDirectionsOpen)
{
  std::vector<Eigen::Vector3f> ground;
  for (int x = -40; x <= 40; ++x)
  {
    for (int y = -40; y <= 40; ++y)
    {
      ground.emplace_back(0.5F * static_cast<float>(x), 0.5F * static_cast<float>(y), -1.7F);
    }
  }
  const auto result = RegistrationTarget(ground, {}).align(ground, Pose::Identity());
  EXPECT_LT(result.observability, 1e-3);
}

TEST(KeyframeRegistration, EmptyOnePointAndNanCloudsDoNotConverge)
{
  const std::vector<Eigen::Vector3f> none;
  const std::vector<Eigen::Vector3f> one = {Eigen::Vector3f(1, 2, 3)};
  const std::vector<Eigen::Vector3f> nan(100, Eigen::Vector3f::Constant(NAN));
  for (const auto& target : {none, one, nan})
  {
    for (const auto& source : {none, one, nan})
    {
      EXPECT_FALSE(RegistrationTarget(target, {}).align(source, Pose::Identity()).converged);
      EXPECT_FALSE(correlateFromAbove(source, target, Pose::Identity(), 5, 0.1).has_value());
    }
  }
}

TEST(CorrelateFromAbove, FindsOffsetAndHeading)
{
  const BoxWorld world(3, 40, 25);
  const Pose a = poseFromYpr(0, -25, 1.7, 0, 0, 0);
  const Pose T = poseFromYpr(3.2, -1.6, 0, 1.24, 0, 0);
  const auto initial = correlateFromAbove(world.scan(a * T, 2), world.scan(a, 1),
                                          poseFromYpr(0, 0, 0, 1.2, 0, 0), 5, 0.07);
  ASSERT_TRUE(initial.has_value());
  const Pose error = T.inverse() * *initial;
  EXPECT_LT(error.translation().norm(), 1.0);
  EXPECT_LT(rotationAngle(error), 0.05);
}

TEST(PolarDescriptor, KnowsAPlaceFromAnyHeading)
{
  const BoxWorld world(4, 40, 25);
  const Pose here = poseFromYpr(5, -25, 1.7, 0, 0, 0);
  const PolarDescriptor descriptor(world.scan(here, 1), 60);
  for (const double heading : {0.0, 0.5, -1.3, 3.0})
  {
    const Pose T = poseFromYpr(0.4, 0.3, 0, heading, 0, 0);
    const auto match = descriptor.match(PolarDescriptor(world.scan(here * T, 2), 60));
    EXPECT_LT(match.distance, 0.3);
    EXPECT_LT(std::abs(std::remainder(match.heading - heading, 2 * M_PI)), 0.11) << heading;
  }
  const auto elsewhere = descriptor.match(
      PolarDescriptor(world.scan(poseFromYpr(40, 10, 1.7, M_PI / 2, 0, 0), 3), 60));
  EXPECT_GT(elsewhere.distance, 0.3);
  EXPECT_EQ(PolarDescriptor({}, 60).match(descriptor).distance, 1);
}

class RealScans : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    DYSLAM_REQUIRE_DATA();
    data_ = *realDataFolder();
  }

  [[nodiscard]] std::vector<Eigen::Vector3f> frame(int number) const
  {
    char name[16];
    std::snprintf(name, sizeof name, "%06d.bin", number);
    return readBin(data_ + "/kitti_raw_2011_09_26_drive_0005/velodyne/" + name);
  }

  std::string data_;
};

TEST_F(RealScans, AScanMovedByAKnownMotionIsFound)
{
  const auto points = frame(20);
  ASSERT_GT(points.size(), 50000U);
  RegistrationTarget target(sampled(points), {});
  for (const Pose& T :
       {poseFromYpr(2, 0.5, 0, 0.05, 0, 0), poseFromYpr(0.5, 0, 0.2, -0.03, 0.01, 0.02),
        poseFromYpr(-3, -1, 0.1, -0.2, 0, 0.02)})
  {
    std::vector<Eigen::Vector3f> moved;
    const Eigen::Isometry3f back = T.inverse().cast<float>();
    for (const Eigen::Vector3f& p : points)
    {
      moved.emplace_back(back * p);
    }
    const auto source = sampled(moved);
    const auto initial = correlateFromAbove(source, target.points(), Pose::Identity(), 5, 0.25);
    ASSERT_TRUE(initial.has_value());
    const auto result = target.align(source, *initial);
    EXPECT_TRUE(result.converged);
    const Pose error = T.inverse() * result.T_target_source;
    EXPECT_LT(error.translation().norm(), 0.03);
    EXPECT_LT(rotationAngle(error), 0.002);
    EXPECT_GT(result.overlap, 0.8);
  }
}

TEST_F(RealScans, UnrelatedScansAreToldApart)
{
  const auto here = frame(20);
  ASSERT_GT(here.size(), 50000U);
  RegistrationTarget target(sampled(here), {});
  const PolarDescriptor descriptor(here, 60);
  const auto check =
      [&](const std::string& name, const std::vector<Eigen::Vector3f>& there, bool same)
  {
    ASSERT_GT(there.size(), 10000U) << name;
    const auto match = descriptor.match(PolarDescriptor(there, 60));
    const auto source = sampled(there);
    const Pose turned = poseFromYpr(0, 0, 0, match.heading, 0, 0);
    const auto result = target.align(
        source, correlateFromAbove(source, target.points(), turned, 5, 0.1).value_or(turned));
    if (same)
    {
      EXPECT_TRUE(result.converged) << name;
      EXPECT_GT(result.overlap, 0.75) << name;
      EXPECT_LT(result.rmse, 0.1) << name;
      EXPECT_LT(match.distance, 0.4) << name;
    }
    else
    {
      EXPECT_LT(result.overlap, 0.4) << name;
      EXPECT_GT(match.distance, 0.4) << name;
    }
  };
  for (const int number : {18, 21, 24, 27})
  {
    check("frame " + std::to_string(number), frame(number), true);
  }
  for (const int number : {60, 80, 100})
  {
    check("frame " + std::to_string(number), frame(number), false);
  }
  for (int number = 10; number < 40; number += 3)
  {
    char name[16];
    std::snprintf(name, sizeof name, "%06d.bin", number);
    check(name, readBin(data_ + "/hdl64_singles_sceneflow/" + name), false);
  }
}
}  // namespace
}  // namespace dyslam
