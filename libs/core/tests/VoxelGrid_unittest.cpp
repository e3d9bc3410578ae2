// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/VoxelGrid.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <unordered_map>

namespace dyslam
{
namespace
{
std::vector<Eigen::Vector3f> randomPoints(int count)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<float> u(-6, 6);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < count; ++i)
  {
    const float x = u(random), y = u(random), z = u(random);
    points.emplace_back(x, y, z);
  }
  points[3].z() = std::numeric_limits<float>::infinity();
  points[5].x() = std::numeric_limits<float>::quiet_NaN();
  return points;
}

TEST(VoxelHash, KeepsWhatAMapKeeps)
{
  std::mt19937_64 random(1);
  VoxelHash hash;
  std::unordered_map<std::uint64_t, std::uint32_t> truth;
  for (int round = 0; round < 2; ++round)
  {
    for (std::uint32_t i = 0; i < 5000; ++i)
    {
      const std::uint64_t key = random() % 3000 * 0x100000001ULL;
      EXPECT_EQ(hash.findOrInsert(key, i), truth.emplace(key, i).first->second);
      const std::uint64_t other = random() % 3000 * 0x100000001ULL;
      const auto at = truth.find(other);
      EXPECT_EQ(hash.find(other), at == truth.end() ? VoxelHash::none : at->second);
    }
    EXPECT_EQ(hash.size(), truth.size());
    hash.clear();
    truth.clear();
    EXPECT_EQ(hash.size(), 0U);
    EXPECT_EQ(hash.find(0), VoxelHash::none);
  }
}

TEST(VoxelGrid, KeysTellCellsApartOnBothSidesOfZero)
{
  std::map<std::uint64_t, std::tuple<int, int, int>> cells;
  for (const int x : {-1048576, -2, -1, 0, 1, 1048575})
  {
    for (const int y : {-1048576, -1, 0, 1048575})
    {
      for (const int z : {-1048576, -1, 0, 1048575})
      {
        EXPECT_TRUE(cells.emplace(voxelKey({x, y, z}), std::tuple(x, y, z)).second);
      }
    }
  }
  const VoxelCell cell = voxelCell({-0.1F, 0.1F, 1.0F}, 2);
  EXPECT_EQ(std::tuple(cell.x, cell.y, cell.z), std::tuple(-1, 0, 2));
}

TEST(VoxelGrid, PointsTooFarAwayAreInTheLastCells)
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const VoxelCell last = voxelCell({infinity, -infinity, infinity}, 10);
  EXPECT_EQ(last.x, -last.y);
  EXPECT_LT(last.x, std::numeric_limits<std::int32_t>::max());  // there are neighbours
  const VoxelCell home = voxelCell({1, 2, 3}, 10);
  for (const float far : {3e8F, 1e20F, std::numeric_limits<float>::max()})
  {
    const VoxelCell cell = voxelCell({far, -far, far}, 10);
    EXPECT_EQ(std::tuple(cell.x, cell.y, cell.z), std::tuple(last.x, last.y, last.z)) << far;
    EXPECT_NE(voxelKey(voxelCell({far, 2, 3}, 10)), voxelKey(home)) << far;
    EXPECT_NE(voxelKey(cell), voxelKey({0, 0, 0})) << far;
  }
  const VoxelCell near = voxelCell({-1e8F, 1e8F, 0}, 10);
  EXPECT_EQ(std::tuple(near.x, near.y, near.z), std::tuple(-1000000000, 1000000000, 0));
}

TEST(VoxelGrid, SamplesLikeAMapOfCells)
{
  const std::vector<Eigen::Vector3f> points = randomPoints(3000);
  const auto cellOf = [](const Eigen::Vector3f& p)
  {
    const Eigen::Vector3i c = (p * 1.25F).array().floor().cast<int>();
    return std::tuple(c.x(), c.y(), c.z());
  };
  std::map<std::tuple<int, int, int>, std::size_t> voxel_of;
  std::vector<std::vector<std::uint32_t>> members;
  for (std::uint32_t i = 0; i < points.size(); ++i)
  {
    if (points[i].allFinite())
    {
      const std::size_t voxel = voxel_of.emplace(cellOf(points[i]), members.size()).first->second;
      members.resize(std::max(members.size(), voxel + 1));
      members[voxel].push_back(i);
    }
  }
  const VoxelSample first = voxelDownsample(points, 0.8);
  const VoxelSample mean = voxelDownsample(points, 0.8, VoxelPick::centroid);
  ASSERT_EQ(first.index.size(), members.size());
  EXPECT_EQ(mean.index, first.index);
  for (std::size_t v = 0; v < members.size(); ++v)
  {
    EXPECT_EQ(first.index[v], members[v].front());
    EXPECT_EQ(first.points[v], points[members[v].front()]);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : members[v])
    {
      sum += points[i].cast<double>();
    }
    const Eigen::Vector3d centroid = sum / static_cast<double>(members[v].size());
    EXPECT_LT((mean.points[v].cast<double>() - centroid).norm(), 1e-5);
  }
  EXPECT_TRUE(voxelDownsample({}, 0.5).points.empty());
  EXPECT_THROW((void)voxelDownsample(points, 0), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam
