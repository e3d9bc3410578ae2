// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Normals.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace dyslam
{
namespace
{
TEST(Normals, OfNoisyPlanesLookToTheViewpoint)
{
  std::mt19937 random(6);
  std::uniform_real_distribution<float> u(-1, 1);
  ThreadPool pool(2);
  for (int plane = 0; plane < 10; ++plane)
  {
    const float nx = u(random), ny = u(random), nz = u(random);
    const Eigen::Vector3f normal = Eigen::Vector3f(nx, ny, nz).normalized();
    const Eigen::Vector3f along = normal.unitOrthogonal(), across = normal.cross(along);
    const Eigen::Vector3f middle = 5 * along - 3 * normal;
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 800; ++i)
    {
      const float a = 2 * u(random), b = 2 * u(random), off = 0.005F * u(random);
      points.push_back(middle + a * along + b * across + off * normal);
    }
    const Eigen::Vector3f viewpoint = middle + (plane % 2 == 0 ? 4.0F : -4.0F) * normal;
    const Eigen::Vector3f seen = plane % 2 == 0 ? normal : Eigen::Vector3f(-normal);
    const KdTree tree(points);
    const auto shapes = estimateNormals(points, tree, 12, 1, viewpoint, pool);
    ASSERT_EQ(shapes.size(), points.size());
    for (std::size_t i = 0; i < shapes.size(); ++i)
    {
      ASSERT_TRUE(shapes[i].valid());
      EXPECT_NEAR(shapes[i].normal.norm(), 1, 1e-5);
      EXPECT_GT(shapes[i].normal.dot(seen), 0.99F);
      EXPECT_LT((shapes[i].mean - points[i]).norm(), 0.6F);
      EXPECT_LT(shapes[i].spread.x(), 0.006F);
      EXPECT_LE(shapes[i].spread.x(), shapes[i].spread.y());
      EXPECT_LE(shapes[i].spread.y(), shapes[i].spread.z());
    }
  }
}

TEST(Normals, AreUnknownWithoutAPlane)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(fitLocalShape({}, Eigen::Vector3f::Zero()).valid());
  EXPECT_FALSE(fitLocalShape({{1, 0, 0}, {0, 1, 0}}, Eigen::Vector3f::Zero()).valid());
  EXPECT_FALSE(fitLocalShape({{1, 0, 0}, {2, 0, 0}, {4, 0, 0}}, Eigen::Vector3f::Zero()).valid());
  // The last one has no neighbours within reach.
  const std::vector<Eigen::Vector3f> points{
      {1, 0, 0}, {1.1F, 0, 0}, {1, 0.1F, 0}, {nan, 0, 0}, {9, 9, 9}};
  ThreadPool pool(1);
  const auto shapes =
      estimateNormals(points, KdTree(points), 3, 0.5F, Eigen::Vector3f(0, 0, 2), pool);
  EXPECT_TRUE(shapes[0].valid() && shapes[1].valid() && shapes[2].valid());
  EXPECT_TRUE(shapes[0].normal.isApprox(Eigen::Vector3f::UnitZ(), 1e-5F));
  EXPECT_FALSE(shapes[3].valid() || shapes[4].valid());
}
}  // namespace
}  // namespace dyslam
