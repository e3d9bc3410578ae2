// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/NeighbourSearch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace dyslam
{
namespace
{
/** All points by distance, ties by index. */
std::vector<Neighbour> byDistance(const std::vector<Eigen::Vector3f>& points,
                                  const Eigen::Vector3f& query)
{
  std::vector<Neighbour> all;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (points[i].allFinite())
    {
      all.push_back({static_cast<std::uint32_t>(i), (points[i] - query).squaredNorm()});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const Neighbour& a, const Neighbour& b)
            {
              return a.squared_distance < b.squared_distance ||
                     (a.squared_distance == b.squared_distance && a.index < b.index);
            });
  return all;
}

void expectSame(const std::vector<Neighbour>& found, const std::vector<Neighbour>& truth)
{
  ASSERT_EQ(found.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    EXPECT_EQ(found[i].index, truth[i].index);
    EXPECT_EQ(found[i].squared_distance, truth[i].squared_distance);
  }
}

/** On a lattice of half metres, so that distances are exact and many are equal; a few are NaN. */
std::vector<Eigen::Vector3f> latticePoints(std::mt19937& random, int count, int half_width)
{
  std::uniform_int_distribution<int> step(-half_width, half_width);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < count; ++i)
  {
    const int x = step(random), y = step(random), z = step(random);
    points.push_back(0.5F * Eigen::Vector3i(x, y, z).cast<float>());
    if (i % 50 == 7)
    {
      points.back().y() = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return points;
}

TEST(KdTree, FindsWhatALookAtAllPointsFinds)
{
  std::mt19937 random(1);
  for (const int count : {1, 5, 60, 1500})
  {
    const std::vector<Eigen::Vector3f> points = latticePoints(random, count, 8);
    const KdTree tree(points);
    std::vector<Neighbour> found;
    for (const Eigen::Vector3f& query : latticePoints(random, 40, 10))
    {
      if (!query.allFinite())
      {
        continue;
      }
      const std::vector<Neighbour> all = byDistance(points, query);
      for (const float within : {0.0F, 1.5F, 4.0F, std::numeric_limits<float>::infinity()})
      {
        const auto beyond =
            std::find_if(all.begin(), all.end(),
                         [&](const Neighbour& n) { return n.squared_distance > within * within; });
        const std::vector<Neighbour> near(all.begin(), beyond);
        for (const std::size_t k : {1U, 7U, 4000U})
        {
          tree.nearest(query, k, found, within);
          const auto taken = static_cast<std::ptrdiff_t>(std::min(k, near.size()));
          expectSame(found, {near.begin(), near.begin() + taken});
        }
        Neighbour one;
        ASSERT_EQ(tree.nearest(query, one, within), !near.empty());
        if (!near.empty())
        {
          expectSame({one}, {near.front()});
        }
      }
    }
  }
}

TEST(KdTree, FindsNothingWhereNothingIs)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Neighbour> found{{1, 1}};
  Neighbour one;
  for (const KdTree& tree :
       {KdTree(), KdTree(std::vector<Eigen::Vector3f>{}), KdTree({{nan, 0, 0}})})
  {
    EXPECT_EQ(tree.size(), 0U);
    EXPECT_FALSE(tree.nearest({0, 0, 0}, one));
    tree.nearest({0, 0, 0}, 3, found);
    EXPECT_TRUE(found.empty());
  }
  EXPECT_FALSE(KdTree({{1, 2, 3}}).nearest({nan, 0, 0}, one));
}
}  // namespace
}  // namespace dyslam
