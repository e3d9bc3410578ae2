// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/MapGround.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace dyslam
{
namespace
{
/** A slope of 10 %, from x = 0 to 20 m, a point per 0.2 m. */
std::vector<Eigen::Vector3f> slope()
{
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i)
  {
    for (int k = 0; k < 100; ++k)
    {
      const float x = 0.2F * static_cast<float>(i) + 0.1F;
      points.emplace_back(x, 0.2F * static_cast<float>(k) + 0.1F, 0.1F * x);
    }
  }
  return points;
}

TEST(MapGround, HeightIsOverTheGroundAround)
{
  std::vector<Eigen::Vector3f> points = slope();
  const Eigen::Vector3f lamp(15.1F, 5, 1.51F + 6);
  points.push_back(lamp);
  points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  const MapGround ground(points);
  EXPECT_NEAR(ground.heightOver(lamp), 6, 0.2) << "a square of 2 m has a slope of 0.2 m";
  EXPECT_NEAR(ground.heightOver(points.front()), 0, 0.2);
  EXPECT_THROW((void)ground.heightOver({-50, 0, 0}), std::out_of_range);
}

/** Reflections make pits of many points; they do not lift what is beside them. */
TEST(MapGround, DoesNotLieInPits)
{
  std::vector<Eigen::Vector3f> points = slope();
  for (int i = 0; i < 100; ++i)
  {
    points.emplace_back(11, 11, -3.0F);
  }
  const Eigen::Vector3f post(11, 11, 1.1F + 2);
  points.push_back(post);
  EXPECT_NEAR(MapGround(points).heightOver(post), 2, 0.2);
}
/** In a square without floor the ground is that of the wall, but not around it. */
TEST(MapGround, KnowsTheLowestGroundAround)
{
  std::vector<Eigen::Vector3f> points;
  for (const auto& p : slope())
  {
    if (std::abs(p.x() - 11) > 1 || std::abs(p.y() - 11) > 1)
    {
      points.push_back(p);
    }
  }
  for (int k = 0; k < 40; ++k)
  {
    points.emplace_back(11, 11, 2 + 0.1F * static_cast<float>(k));
  }
  const MapGround ground(points);
  const Eigen::Vector3f top(11, 11, 6);
  EXPECT_LT(ground.heightOver(top), 4.2);
  EXPECT_NEAR(ground.heightOverLowest(top), 6 - 0.8, 0.1);
}
}  // namespace
}  // namespace dyslam
