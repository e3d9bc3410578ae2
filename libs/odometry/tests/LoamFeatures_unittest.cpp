// SPDX-License-Identifier: BSD-3-Clause
#include "matchers/LoamFeatures.h"

#include <gtest/gtest.h>

#include "TestScene.h"

namespace dyslam
{
namespace
{
void expectSame(const std::vector<LoamPoint>& found,
                const std::vector<LoamPoint>& from_lidar,
                const Pose& T_vehicle_lidar)
{
  ASSERT_EQ(found.size(), from_lidar.size());
  EXPECT_GT(found.size(), 100U);
  for (std::size_t i = 0; i < found.size(); ++i)
  {
    EXPECT_EQ(found[i].ring, from_lidar[i].ring);
    EXPECT_LT((found[i].p - T_vehicle_lidar.cast<float>() * from_lidar[i].p).norm(), 1e-4F);
  }
}

TEST(LoamFeatures, DoNotDependOnWhereTheVehicleHasItsOrigin)
{
  const Frame frame = test::StreetScene().frame(Pose::Identity(), 0.01, 1);
  Frame bare = frame;
  const Eigen::Isometry3f T_lidar_vehicle = frame.scan.T_vehicle_lidar.inverse().cast<float>();
  for (Eigen::Vector3f& p : bare.cloud.points)
  {
    p = T_lidar_vehicle * p;
  }
  bare.scan.T_vehicle_lidar.setIdentity();
  for (const bool with_rings : {true, false})
  {
    Frame ours = frame, theirs = bare;
    if (!with_rings)
    {
      ours.cloud.source.clear();
      theirs.cloud.source.clear();
    }
    const LoamFeatures found = loamFeatures(ours, LoamOptions());
    const LoamFeatures from_lidar = loamFeatures(theirs, LoamOptions());
    const Pose& T = frame.scan.T_vehicle_lidar;
    expectSame(found.edges, from_lidar.edges, T);
    expectSame(found.target_edges, from_lidar.target_edges, T);
    expectSame(found.planes, from_lidar.planes, T);
  }
}

TEST(LoamFeatures, AreOfThePointsOfTheFirstLidar)
{
  for (const bool with_rings : {true, false})
  {
    Frame own = test::StreetScene().frame(Pose::Identity(), 0.01, 1);
    if (!with_rings)
    {
      own.scan.ring.clear();
    }
    const Frame both = test::withFurtherLidar(own);
    ASSERT_GT(both.cloud.size(), own.cloud.size() + 1000);
    const LoamFeatures found = loamFeatures(both, LoamOptions());
    const LoamFeatures alone = loamFeatures(own, LoamOptions());
    expectSame(found.edges, alone.edges, Pose::Identity());
    expectSame(found.target_edges, alone.target_edges, Pose::Identity());
    expectSame(found.planes, alone.planes, Pose::Identity());
    expectSame(found.target_planes, alone.target_planes, Pose::Identity());
  }
}

TEST(LoamFeatures, PointsAtTheLidarAreNone)
{
  Frame frame = test::StreetScene().frame(Pose::Identity(), 0.01, 1);
  const Eigen::Vector3f lidar = frame.scan.T_vehicle_lidar.translation().cast<float>();
  for (std::size_t i = 0; i < frame.cloud.size(); i += 3)
  {
    frame.cloud.points[i] = lidar;
  }
  const LoamFeatures found = loamFeatures(frame, LoamOptions());
  EXPECT_GT(found.planes.size(), 100U);
  for (const auto* features : {&found.target_edges, &found.target_planes})
  {
    for (const LoamPoint& feature : *features)
    {
      EXPECT_GT((feature.p - lidar).norm(), 0.1F);
    }
  }
}
}  // namespace
}  // namespace dyslam
