// SPDX-License-Identifier: BSD-3-Clause
#include "local_map/SurfacePyramid.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
/** A wall at y = 5 of the base, seen by rings `step` apart in height. */
std::vector<Eigen::Vector3f> ringsOnWall(float step)
{
  std::vector<Eigen::Vector3f> points;
  for (float z = -3; z <= 3; z += step)
  {
    for (float x = -6; x <= 6; x += 0.05F)
    {
      points.emplace_back(x, 5, z);
    }
  }
  return points;
}

constexpr float min_planarity = 0.2F;
}  // namespace

TEST(SurfacePyramid, DenseSurfacesAreReadFromTheSmallestCells)
{
  ThreadPool pool(1);
  SurfacePyramid one(0.4, 1, 1e6, pool);
  SurfacePyramid three(0.4, 3, 1e6, pool);
  one.add(ringsOnWall(0.1F), {}, Pose::Identity());
  three.add(ringsOnWall(0.1F), {}, Pose::Identity());
  const Eigen::Vector3d place(0.3, 4.2, 0.2);
  const Eigen::Vector3f q =
      (Eigen::Vector3d(0.5, 5.05, 0.3) - one.baseAt(place).origin).cast<float>();
  const Surface a = one.surfaceAt(q, one.baseAt(place), min_planarity);
  const Surface b = three.surfaceAt(q, three.baseAt(place), min_planarity);
  ASSERT_GT(a.count, 0);
  EXPECT_EQ(a.count, b.count);
  EXPECT_LT((a.mean - b.mean).norm(), 1e-5F);
  EXPECT_LT((a.normal - b.normal).norm(), 1e-5F);
}

TEST(SurfacePyramid, RingsFarApartHaveASurfaceInLargerCells)
{
  ThreadPool pool(1);
  SurfacePyramid one(0.4, 1, 1e6, pool);
  SurfacePyramid three(0.4, 3, 1e6, pool);
  const Pose T_map_body(Eigen::Translation3d(1000, -700, 30));
  one.add(ringsOnWall(1.2F), {}, T_map_body);
  three.add(ringsOnWall(1.2F), {}, T_map_body);
  const Eigen::Vector3d place(1000.3, -695.3, 30.1);
  const SurfacePyramid::Base base = three.baseAt(place);
  const Eigen::Vector3f q = (Eigen::Vector3d(1000.5, -694.9, 30.6) - base.origin).cast<float>();
  EXPECT_EQ(one.surfaceAt(q, one.baseAt(place), min_planarity).count, 0);
  const Surface surface = three.surfaceAt(q, base, min_planarity);
  ASSERT_GT(surface.count, 0);
  EXPECT_NEAR(std::abs(surface.normal.y()), 1, 1e-4);
  EXPECT_NEAR(surface.mean.y() + static_cast<float>(base.origin.y()), -695, 1e-3);
}

TEST(SurfacePyramid, RestartForgetsAndChangesTheLevels)
{
  ThreadPool pool(1);
  SurfacePyramid map(0.4, 1, 1e6, pool);
  map.add(ringsOnWall(0.5F), {}, Pose::Identity());
  EXPECT_GT(map.size(), 0U);
  map.restart(0.6, 4);
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.levels(), 4);
  EXPECT_FLOAT_EQ(map.cellSize(), 0.6F);
  EXPECT_EQ(map.coarser(2).levels(), 1);
}
}  // namespace dyslam
