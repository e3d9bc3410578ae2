// SPDX-License-Identifier: BSD-3-Clause
#include "../src/Segments.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>

namespace dyslam
{
namespace
{
constexpr double voxel = 0.2;
constexpr double cell = 0.6;

TEST(Segments, JoinPointsOfCellsThatTouch)
{
  const std::vector<Eigen::Vector3f> points = {
      {0.1F, 0.1F, 0.1F}, {0.7F, 0.7F, 0.7F}, {3, 0, 0}, {0.15F, 0.1F, 0.1F}, {1, 1, 1}};
  const Segments segments = findSegments(points, {true, true, true, true, false}, voxel, cell);
  EXPECT_EQ(segments.segments, 2U);
  EXPECT_EQ(segments.voxel_of_point[0], segments.voxel_of_point[3]) << "one voxel";
  EXPECT_EQ(segments.voxel_of_point[4], Segments::none) << "not used";
  const auto segmentOf = [&](std::size_t point)
  { return segments.segment_of_voxel[segments.voxel_of_point[point]]; };
  EXPECT_EQ(segmentOf(0), segmentOf(1));
  EXPECT_NE(segmentOf(0), segmentOf(2));
}

TEST(Segments, NeighboursAreTheCellsAround)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-3, 3);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300; ++i)
  {
    points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  }
  const Segments segments =
      findSegments(points, std::vector<bool>(points.size(), true), voxel, cell);
  const auto touch = [&](const VoxelCell& a, const VoxelCell& b)
  { return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && std::abs(a.z - b.z) <= 1; };
  ASSERT_GT(segments.cells.size(), 100U);
  for (std::uint32_t i = 0; i < segments.cells.size(); ++i)
  {
    std::set<std::uint32_t> expected;
    for (std::uint32_t j = 0; j < segments.cells.size(); ++j)
    {
      if (touch(segments.cells[i], segments.cells[j]))
      {
        expected.insert(j);
      }
    }
    std::set<std::uint32_t> found;
    segments.forEachNeighbour(i, [&](std::uint32_t n) { found.insert(n); });
    EXPECT_EQ(found, expected);
  }
}
}  // namespace
}  // namespace dyslam
