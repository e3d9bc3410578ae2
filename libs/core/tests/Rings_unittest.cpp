// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Rings.h>
#include <dyslam/core/Scan.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace dyslam
{
namespace
{
struct Rings
{
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint16_t> ring;
};

/** One ring after the other, the highest first, each clockwise from behind, as KITTI's files; some
 * beams give no return. */
Rings ringAfterRing(int rings, int columns)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> range(3, 60);
  Rings scan;
  for (int r = rings - 1; r >= 0; --r)
  {
    const double elevation = (-20.02 + 1.3 * r) * M_PI / 180;
    for (int c = 0; c < columns; ++c)
    {
      const double azimuth = M_PI - 2 * M_PI * (c + 0.5) / columns;
      const double d = range(random);
      const bool lost = c > 0 && random() % 10 == 0;
      scan.points.push_back(lost ? Eigen::Vector3f(Eigen::Vector3f::Zero())
                                 : Eigen::Vector3d(d * std::cos(elevation) * std::cos(azimuth),
                                                   d * std::cos(elevation) * std::sin(azimuth),
                                                   d * std::sin(elevation))
                                       .cast<float>());
      scan.ring.push_back(static_cast<std::uint16_t>(r));
    }
  }
  return scan;
}

TEST(Rings, AreTakenFromTheOrderOfAFile)
{
  const Rings scan = ringAfterRing(24, 360);
  EXPECT_EQ(estimateRings(scan.points), scan.ring);
}

TEST(Rings, AreTakenFromTheElevationsWhereTheOrderIsLost)
{
  Rings scan = ringAfterRing(24, 360);
  std::vector<std::size_t> order(scan.points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = i;
  }
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  std::vector<Eigen::Vector3f> shuffled;
  for (const std::size_t i : order)
  {
    shuffled.push_back(scan.points[i]);
  }
  const std::vector<std::uint16_t> rings = estimateRings(shuffled);
  ASSERT_EQ(rings.size(), shuffled.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    if (isReturn(shuffled[i]))
    {
      EXPECT_EQ(rings[i], scan.ring[order[i]]);
    }
  }
}

/** As in nuScenes, where lasers without a return have points on the sensor. */
TEST(Rings, AreFoundDespitePointsAtTheSensor)
{
  const Rings scan = ringAfterRing(24, 360);
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint16_t> truth;
  std::mt19937 random(6);
  std::uniform_real_distribution<float> place(-0.4F, 0.4F);
  for (std::size_t c = 0; c < 360; ++c)
  {
    for (std::size_t r = 0; r < 24; ++r)
    {
      const bool lost = random() % 3 == 0;
      points.push_back(lost ? Eigen::Vector3f(place(random), place(random), place(random))
                            : scan.points[r * 360 + c]);
      truth.push_back(scan.ring[r * 360 + c]);
    }
  }
  const std::vector<std::uint16_t> rings = estimateRings(points);
  ASSERT_EQ(rings.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (points[i].norm() > 1)
    {
      EXPECT_EQ(rings[i], truth[i]);
    }
  }
}

TEST(Rings, AreUnknownWithoutReturnsOrOrder)
{
  EXPECT_TRUE(estimateRings({}).empty());
  EXPECT_TRUE(estimateRings(std::vector<Eigen::Vector3f>(100, Eigen::Vector3f::Zero())).empty());
  EXPECT_TRUE(estimateRings({{1, 2, 3}}).empty());
}

TEST(AzimuthColumn, ColumnsRunClockwiseFromBehind)
{
  EXPECT_EQ(azimuthColumn({-1, 0.001F, 0}, 8), 0);
  EXPECT_EQ(azimuthColumn({0.1F, 1, 0}, 8), 2);
  EXPECT_EQ(azimuthColumn({1, -0.001F, 0}, 8), 4);
  EXPECT_EQ(azimuthColumn({-1, -0.001F, 0}, 8), 7);
}
}  // namespace
}  // namespace dyslam
