// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/PreparedScan.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "SyntheticScan.h"

namespace dyslam
{
namespace
{
TEST(PreparedScan, HandlesEmptyAndInvalidInput)
{
  const PreparedScan empty = prepareScan({});
  EXPECT_TRUE(empty.empty());
  EXPECT_EQ(empty.levels[1].size(), 2048U);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const PreparedScan broken = prepareScan({{nan, 0, 0}, {infinity, 0, 0}, {0, 0, 0}, {0.1F, 0, 0}});
  EXPECT_TRUE(broken.empty());
  const PreparedScan one = prepareScan({{10, 1, -1}});
  EXPECT_EQ(one.valid_points, 1U);
}

TEST(PreparedScan, CellsContainTheNearestPoint)
{
  const std::vector<Eigen::Vector3f> points = {{20, 0, -1}, {10, 0, -0.5F}, {30, 0, -1.5F}};
  const PreparedScan scan = prepareScan(points);
  std::set<std::int32_t> sources(scan.source.begin(), scan.source.end());
  EXPECT_TRUE(sources.count(1));
  for (std::size_t cell = 0; cell < scan.source.size(); ++cell)
  {
    if (scan.source[cell] >= 0)
    {
      EXPECT_EQ(scan.points[cell], points[static_cast<std::size_t>(scan.source[cell])]);
    }
  }
}

TEST(PreparedScan, LevelsSelectOccupiedCellsOfTheirBlock)
{
  const PreparedScan scan = prepareScan(testing::room(64, 1800));
  for (std::size_t l = 0; l < PreparedScan::level_count; ++l)
  {
    const PreparedScan::Level& level = scan.levels[l];
    ASSERT_EQ(level.size(), static_cast<std::size_t>(level.rows * level.cols));
    std::size_t occupied = 0;
    for (std::size_t node = 0; node < level.size(); ++node)
    {
      const std::int32_t cell = level.cell[node];
      if (cell < 0)
      {
        continue;
      }
      ++occupied;
      EXPECT_GE(scan.source[static_cast<std::size_t>(cell)], 0);
      const int row = cell / PreparedScan::columns;
      const int col = cell % PreparedScan::columns;
      EXPECT_EQ(row * level.rows / scan.rows, static_cast<int>(node) / level.cols);
      // Blocks of the first level end at rounded columns.
      const double middle = (col + 0.5) * level.cols / PreparedScan::columns;
      EXPECT_NEAR(middle, static_cast<int>(node) % level.cols + 0.5, 0.75);
    }
    EXPECT_GT(occupied, level.size() * 9 / 10) << "level " << l;
  }
}

TEST(PreparedScan, NormalsPointToTheSensor)
{
  const PreparedScan scan = prepareScan(testing::room(64, 1800));
  std::size_t good = 0;
  std::size_t all = 0;
  for (std::size_t node = 0; node < scan.normals.size(); ++node)
  {
    const std::int32_t cell = scan.levels[1].cell[node];
    if (cell < 0 || scan.planarity[node] < 0.8F)
    {
      continue;
    }
    ++all;
    EXPECT_LE(scan.normals[node].dot(scan.points[static_cast<std::size_t>(cell)]), 0);
    good += scan.normals[node].cwiseAbs().maxCoeff() > 0.99F;
  }
  EXPECT_GT(all, 1000U);
  EXPECT_GT(good, all * 9 / 10);
}

TEST(PreparedScan, SparseSensorsHaveOneRowPerBeam)
{
  const PreparedScan scan = prepareScan(testing::room(16, 1800));
  EXPECT_EQ(scan.rows, 16);
  EXPECT_EQ(scan.levels[0].rows, 16);
  const PreparedScan dense = prepareScan(testing::room(64, 1800));
  EXPECT_EQ(dense.rows, 64);
}
}  // namespace
}  // namespace dyslam
