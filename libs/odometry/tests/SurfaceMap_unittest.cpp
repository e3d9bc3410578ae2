// SPDX-License-Identifier: BSD-3-Clause
#include "local_map/SurfaceMap.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace dyslam
{
namespace
{
std::vector<Eigen::Vector3f> randomPoints(std::size_t count, float reach, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> along(-reach, reach);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i)
  {
    points.emplace_back(along(random), along(random), 0.2F * along(random));
  }
  return points;
}

/** The definition: every point weighted by the spline weight of its cell. */
struct Oracle
{
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
Oracle oracle(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& at, double size)
{
  const auto weightAlong = [&](double p, double a)
  {
    const double cell = std::floor(a / size);
    const double f = a / size - cell;
    const double d = std::floor(p / size) - cell;
    if (d == -1)
    {
      return 0.5 * (1 - f) * (1 - f);
    }
    if (d == 1)
    {
      return 0.5 * f * f;
    }
    return d == 0 ? 1 - 0.5 * (1 - f) * (1 - f) - 0.5 * f * f : 0.0;
  };
  Oracle result;
  double sum = 0;
  for (int pass = 0; pass < 2; ++pass)
  {
    for (const Eigen::Vector3f& point : points)
    {
      const Eigen::Vector3d p = point.cast<double>();
      const double w =
          weightAlong(p.x(), at.x()) * weightAlong(p.y(), at.y()) * weightAlong(p.z(), at.z());
      if (pass == 0)
      {
        sum += w;
        result.mean += w * p;
      }
      else
      {
        result.covariance += w / sum * (p - result.mean) * (p - result.mean).transpose();
      }
    }
    if (pass == 0)
    {
      result.mean /= sum;
    }
  }
  return result;
}

TEST(SurfaceMap, AgreesWithDirectSums)
{
  ThreadPool pool(2);
  SurfaceMap map(0.5, 1e6, pool);
  const auto points = randomPoints(20000, 4, 1);
  map.add(points, {}, Pose::Identity());
  for (const Eigen::Vector3f& at : randomPoints(50, 3, 2))
  {
    const Surface surface = map.surfaceAt(at, VoxelCell());
    ASSERT_GT(surface.count, 0);
    const Oracle expected = oracle(points, at.cast<double>(), 0.5);
    EXPECT_LT((surface.mean.cast<double>() - expected.mean).norm(), 1e-4);
    EXPECT_LT((surface.covariance.cast<double>() - expected.covariance).norm(), 1e-4);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(expected.covariance);
    const Eigen::Vector3d n = surface.normal.cast<double>();
    EXPECT_NEAR(n.dot(expected.covariance * n), solver.eigenvalues()[0], 1e-4);
  }
}

TEST(SurfaceMap, KeepsPrecisionFarFromTheOrigin)
{
  ThreadPool pool(1);
  SurfaceMap map(0.5, 1e6, pool);
  Pose far = Pose::Identity();
  far.translation() = Eigen::Vector3d(80000.125, -60000.25, 100);
  std::vector<Eigen::Vector3f> plane;
  for (int i = -20; i <= 20; ++i)
  {
    for (int j = -20; j <= 20; ++j)
    {
      plane.emplace_back(0.1F * static_cast<float>(i), 0.1F * static_cast<float>(j), 0.013F);
    }
  }
  map.add(plane, {}, far);
  const VoxelCell base = map.cellOf(far.translation());
  const Eigen::Vector3f place = (far.translation() - map.corner(base)).cast<float>();
  const Surface surface = map.surfaceAt(place, base);
  EXPECT_NEAR(surface.mean.z() - place.z(), 0.013F, 1e-4F);
  EXPECT_NEAR(std::fabs(surface.normal.z()), 1.0F, 1e-4F);
  EXPECT_GT(surface.planarity, 0.9F);
}

TEST(SurfaceMap, CoarserMapIsTheMapOfLargerCells)
{
  ThreadPool pool(2);
  SurfaceMap fine(0.5, 1e6, pool);
  SurfaceMap coarse(2, 1e6, pool);
  const auto points = randomPoints(5000, 9, 3);
  fine.add(points, {}, Pose::Identity());
  coarse.add(points, {}, Pose::Identity());
  const SurfaceMap made = fine.coarser(4);
  EXPECT_EQ(made.size(), coarse.size());
  for (const Eigen::Vector3f& at : randomPoints(50, 7, 4))
  {
    const Surface a = made.surfaceAt(at, VoxelCell());
    const Surface b = coarse.surfaceAt(at, VoxelCell());
    EXPECT_LT((a.mean - b.mean).norm(), 1e-3F);
    EXPECT_LT((a.covariance - b.covariance).norm(), 1e-3F);
  }
}

TEST(SurfaceMap, CropForgetsTheFarAndKeepsTheNear)
{
  ThreadPool pool(2);
  SurfaceMap map(0.5, 1e6, pool);
  map.add(randomPoints(20000, 20, 5), {}, Pose::Identity());
  const Surface before = map.surfaceAt(Eigen::Vector3f(1, 1, 0), VoxelCell());
  const std::size_t size = map.size();
  map.crop(Eigen::Vector3d::Zero(), 6);
  EXPECT_LT(map.size(), size / 4);
  for (const Eigen::Vector3f& p : map.means())
  {
    EXPECT_LT(p.norm(), 7);
  }
  const Surface after = map.surfaceAt(Eigen::Vector3f(1, 1, 0), VoxelCell());
  EXPECT_EQ(before.mean, after.mean);
  EXPECT_EQ(map.surfaceAt(Eigen::Vector3f(15, 15, 0), VoxelCell()).count, 0);
}

TEST(SurfaceMap, WeightlessPointsAndEmptyPlacesGiveNothing)
{
  ThreadPool pool(1);
  SurfaceMap map(0.5, 1e6, pool);
  EXPECT_EQ(map.surfaceAt(Eigen::Vector3f::Zero(), VoxelCell()).count, 0);
  const auto points = randomPoints(100, 1, 6);
  map.add(points, std::vector<float>(points.size(), 0.0F), Pose::Identity());
  EXPECT_EQ(map.size(), 0U);
  map.add({{0, 0, 0}}, {}, Pose::Identity());
  EXPECT_EQ(map.size(), 1U);
  EXPECT_EQ(map.surfaceAt(Eigen::Vector3f::Zero(), VoxelCell()).count, 0) << "one point";
}
}  // namespace
}  // namespace dyslam
