// SPDX-License-Identifier: BSD-3-Clause
#include "../src/MovingGroups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace
{
using dyslam::PastVisibility;

const dyslam::MovingGroupsOptions groups = {0.6, 102.4, 12};

void keep(const std::vector<Eigen::Vector3f>& points, std::vector<float>& probability)
{
  const std::vector<PastVisibility> seen(points.size(), PastVisibility::unknown);
  dyslam::keepMovingGroups(points, seen, groups, probability);
}

/** A vertical post of `count` points above one ground point. */
void addPost(float x,
             int count,
             float called,
             std::vector<Eigen::Vector3f>& points,
             std::vector<float>& probability)
{
  points.emplace_back(x, 5, -1.7F);
  probability.push_back(0);
  for (int i = 0; i < count; ++i)
  {
    points.emplace_back(x, 5, -1.4F + 0.1F * static_cast<float>(i));
    probability.push_back(called);
  }
}

TEST(MovingGroups, RejectsSmallGroups)
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> probability;
  addPost(10, 5, 0.8F, points, probability);
  addPost(-20, 15, 0.8F, points, probability);
  keep(points, probability);
  EXPECT_FLOAT_EQ(probability[3], 0.4F);
  EXPECT_FLOAT_EQ(probability[10], 0.8F);
}

TEST(MovingGroups, ClassifiesCellsByMajority)
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> probability;
  addPost(10, 15, 0.8F, points, probability);
  addPost(10, 20, 0.2F, points, probability);
  keep(points, probability);
  EXPECT_FLOAT_EQ(probability[3], 0.4F);
  EXPECT_FLOAT_EQ(probability.back(), 0.2F);
}

TEST(MovingGroups, RejectsFlatGround)
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> probability;
  for (int i = 0; i < 100; ++i)
  {
    points.emplace_back(0.05F * static_cast<float>(i), 3, -1.5F + 0.002F * static_cast<float>(i));
    probability.push_back(0.9F);
  }
  keep(points, probability);
  for (const float p : probability)
  {
    EXPECT_FLOAT_EQ(p, 0.4F);
  }
}

/** A post of 20 points, with numbers of positions that an earlier scan observed occupied and free.
 */
TEST(MovingGroups, RejectsGroupsAtOccupiedPositions)
{
  const auto after = [](std::size_t occupied, std::size_t free)
  {
    std::vector<Eigen::Vector3f> points;
    std::vector<float> probability;
    addPost(10, 20, 0.9F, points, probability);
    std::vector<PastVisibility> seen(points.size(), PastVisibility::unknown);
    std::fill_n(seen.begin() + 1, occupied, PastVisibility::occupied);
    std::fill_n(seen.begin() + 1 + static_cast<std::ptrdiff_t>(occupied), free,
                PastVisibility::free);
    dyslam::keepMovingGroups(points, seen, groups, probability);
    return probability[3];
  };
  EXPECT_FLOAT_EQ(after(20, 0), 0.4F);
  EXPECT_FLOAT_EQ(after(14, 0), 0.4F);
  EXPECT_FLOAT_EQ(after(17, 3), 0.9F) << "its front has come into a free place";
  EXPECT_FLOAT_EQ(after(8, 0), 0.9F) << "hidden before";
  EXPECT_FLOAT_EQ(after(0, 20), 0.9F);
}

TEST(MovingGroups, HandlesEmptyInvalidAndDistantPoints)
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> probability;
  keep(points, probability);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  points = {{nan, 0, 0}, {1000, 0, 0}, {0, 0, 0}};
  probability = {0.9F, 0.9F, 0.9F};
  keep(points, probability);
  EXPECT_FLOAT_EQ(probability[2], 0.4F);
}
}  // namespace
