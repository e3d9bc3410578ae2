// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Ceilings.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/** Adds a horizontal rectangle from the origin, a point per 0.1 m. */
void addFloor(float length, float width, float height, Points& points)
{
  for (int i = 0; 0.1F * static_cast<float>(i) < length; ++i)
  {
    for (int k = 0; 0.1F * static_cast<float>(k) < width; ++k)
    {
      points.emplace_back(0.1F * static_cast<float>(i) + 0.05F,
                          0.1F * static_cast<float>(k) + 0.05F, height);
    }
  }
}

/** Adds a wall along x, a point per 0.1 m. */
void addWall(float length, float y, float height, Points& points)
{
  for (int i = 0; 0.1F * static_cast<float>(i) < length; ++i)
  {
    for (int k = 0; 0.1F * static_cast<float>(k) < height; ++k)
    {
      points.emplace_back(0.1F * static_cast<float>(i) + 0.05F, y, 0.1F * static_cast<float>(k));
    }
  }
}

/** Whether a point is 1 m inside of a rectangle: corners are not seen as ceilings. */
bool isInside(const Eigen::Vector3f& p, float length, float width)
{
  return std::min({p.x(), p.y(), length - p.x(), width - p.y()}) > 1;
}

std::vector<bool> ceilingsOf(const Points& points)
{
  return ceilingPoints(points, MapGround(points));
}

std::size_t count(const std::vector<bool>& flags)
{
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

TEST(Ceilings, OfACorridorAreFoundButNotItsWallsAndShelves)
{
  Points points;
  addFloor(20, 6, 0, points);
  addWall(20, 0.05F, 3, points);
  addWall(20, 5.95F, 3, points);
  addWall(20, 4.05F, 1.5F, points);  // a shelf
  const std::size_t ceiling = points.size();
  addFloor(20, 6, 3, points);
  const std::vector<bool> found = ceilingsOf(points);
  ASSERT_EQ(found.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (isInside(points[i], 20, 6))
    {
      EXPECT_EQ(found[i], i >= ceiling) << points[i].transpose();
    }
  }
  EXPECT_EQ(std::count(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(ceiling), true),
            0);
}

/** In some squares the ceiling alone is seen. */
TEST(Ceilings, AreFoundWhereTheFloorIsNotSeen)
{
  Points points;
  addFloor(20, 10, -1, points);
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const auto& p) {
                                return std::abs(p.x() - 11) < 1.1F && std::abs(p.y() - 5) < 1.1F;
                              }),
               points.end());
  const std::size_t ceiling = points.size();
  addFloor(20, 10, 6, points);
  const std::vector<bool> found = ceilingsOf(points);
  for (std::size_t i = ceiling; i < points.size(); ++i)
  {
    if (isInside(points[i], 20, 10))
    {
      EXPECT_TRUE(found[i]) << points[i].transpose();
    }
  }
}

TEST(Ceilings, OfABridgeAreItsLowerSide)
{
  Points points;
  addFloor(60, 10, 0, points);
  const std::size_t bridge = points.size();
  addFloor(10, 10, 5.5F, points);
  const std::vector<bool> found = ceilingsOf(points);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (i < bridge || isInside(points[i], 10, 10))
    {
      EXPECT_EQ(found[i], i >= bridge) << points[i].transpose();
    }
  }
}

/** On the ground, over it in the open, and too high to be one. */
TEST(Ceilings, AreNotWherePeopleCannotStandBelow)
{
  for (const float height : {0.8F, 2.0F, 14.0F})
  {
    Points points;
    addFloor(20, 6, 0, points);
    addFloor(20, 6, height, points);
    EXPECT_EQ(count(ceilingsOf(points)), 0U) << height;
  }
}

TEST(Ceilings, AreNotLinesFacadesOrTreeTops)
{
  Points points;
  addFloor(30, 20, 0, points);
  const std::size_t others = points.size();
  for (int i = 0; i < 1000; ++i)
  {
    points.emplace_back(0.03F * static_cast<float>(i), 0.01F * static_cast<float>(i), 4.5F);
  }
  addWall(30, 15.05F, 10, points);
  for (int i = 0; i < 3000; ++i)  // a ball of 3 m radius, 6 m over the ground
  {
    const float z = 1 - 2 * (static_cast<float>(i) + 0.5F) / 3000;
    const float angle = 2.4F * static_cast<float>(i);
    const float r = std::sqrt(1 - z * z);
    points.emplace_back(20 + 3 * r * std::cos(angle), 6 + 3 * r * std::sin(angle), 6 + 3 * z);
  }
  EXPECT_LT(count(ceilingsOf(points)), (points.size() - others) / 20);
}

/** An awning on a street is left where it is. */
TEST(Ceilings, OfASmallPartOfTheMapAreNone)
{
  Points points;
  addFloor(60, 40, 0, points);
  addFloor(3, 3, 3, points);
  EXPECT_GT(count(ceilingsOf(points)), 400U);
  EXPECT_EQ(count(ceilingPointsIfMany(points)), 0U);
  addFloor(20, 20, 3, points);
  EXPECT_GT(count(ceilingPointsIfMany(points)), 30000U);
}

TEST(Ceilings, OfNothingAreNone)
{
  EXPECT_TRUE(ceilingPointsIfMany({}).empty());
  EXPECT_EQ(ceilingPointsIfMany({{1, 2, 3}}), std::vector<bool>{false});
  Points points{{nan, 0, 0}, {0, 0, nan}};
  addFloor(10, 6, 0, points);
  addFloor(10, 6, 3, points);
  const std::vector<bool> found = ceilingsOf(points);
  EXPECT_FALSE(found[0]);
  EXPECT_FALSE(found[1]);
  EXPECT_GT(count(found), 5000U);
}
}  // namespace
}  // namespace dyslam
