// SPDX-License-Identifier: BSD-3-Clause
#include "../src/GridGround.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace dyslam
{
namespace
{
constexpr double lowest_obstacle = 0.3;  // of the grid, by default [m]

using Surface = std::function<double(double x, double y)>;

class GridGroundTest : public testing::Test
{
 protected:
  void add(double x, double y, double z, std::uint32_t hits = 3)
  {
    map.points.push_back(Eigen::Vector3d(x, y, z).cast<float>());
    map.hits.push_back(hits);
  }

  /** A point per 0.2 m in a square of 24 m, with noise of a few centimetres. */
  void addGround(const Surface& surface)
  {
    for (double x = -11.9; x < 12; x += 0.2)
    {
      for (double y = -11.9; y < 12; y += 0.2)
      {
        add(x, y, surface(x, y) + 0.03 * std::sin(97 * x + 41 * y));
      }
    }
  }

  /** A box of this height and 1 m by 1 m, around (x, y), in place of the ground. */
  void addBox(const Surface& surface, double x, double y, double height)
  {
    const auto inside = [&](const Eigen::Vector3f& p)
    {
      return std::abs(static_cast<double>(p.x()) - x) < 0.5 &&
             std::abs(static_cast<double>(p.y()) - y) < 0.5;
    };
    map.points.erase(std::remove_if(map.points.begin(), map.points.end(), inside),
                     map.points.end());
    map.hits.resize(map.points.size());
    for (double u = -0.5; u <= 0.51; u += 0.2)
    {
      for (double v = -0.5; v <= 0.51; v += 0.2)
      {
        const bool is_side = std::max(std::abs(u), std::abs(v)) > 0.45;
        for (double z = is_side ? 0.1 : height; z <= height; z += 0.2)
        {
          add(x + u, y + v, surface(x, y) + z);
        }
      }
    }
  }

  [[nodiscard]] static double highestOn(const GridGround& ground, const Surface& surface)
  {
    double highest = -1;
    for (double x = -9; x <= 9; x += 0.25)
    {
      for (double y = -9; y <= 9; y += 0.25)
      {
        highest = std::max(highest, ground.above({x, y, surface(x, y)}));
      }
    }
    return highest;
  }

  MapPoints map;
};

TEST_F(GridGroundTest, SlopesAreFreeAndBoxesStandOnThem)
{
  for (const double degrees : {0.0, 3.0, 6.0, 9.0, 12.0})
  {
    for (const double direction : {0.0, 0.7, M_PI / 2, 4.0})
    {
      const double steepness = std::tan(degrees * M_PI / 180);
      const Surface surface = [&](double x, double y)
      { return 500 + steepness * (std::cos(direction) * x + std::sin(direction) * y); };
      map = {};
      addGround(surface);
      addBox(surface, 2.3, -3.1, 0.8);
      const GridGround ground(map);
      EXPECT_LT(highestOn(ground, surface), 0.1) << degrees << " " << direction;
      const double top = ground.above({2.3, -3.1, surface(2.3, -3.1) + 0.8});
      EXPECT_NEAR(0.85, top, 0.1) << degrees << " " << direction;
    }
  }
}

TEST_F(GridGroundTest, LevelGroundIsTheLowerQuartile)
{
  const Surface level = [](double, double) { return -1.5; };
  for (double x = -7.5; x < 8; ++x)
  {
    for (double y = -7.5; y < 8; ++y)
    {
      add(x, y, -1.5);
    }
  }
  addBox(level, 2.5, 2.5, 1.5);
  const GridGround ground(map);
  for (double x = -7.4; x < 7.5; x += 0.3)
  {
    EXPECT_FLOAT_EQ(0.75F, static_cast<float>(ground.above({x, 0.2, -0.75})));
  }
  EXPECT_TRUE(std::isnan(ground.above({9.5, 0, 0}))) << "off the map";
}

TEST_F(GridGroundTest, HillsAndHollowsAreFree)
{
  for (const double curvature : {1 / 60.0, -1 / 60.0})
  {
    const Surface hill = [&](double x, double y) { return -0.5 * curvature * (x * x + y * y); };
    map = {};
    addGround(hill);
    EXPECT_LT(highestOn(GridGround(map), hill), 0.2) << curvature;
  }
}

TEST_F(GridGroundTest, RampsBeginAndEnd)
{
  const Surface ramp = [](double x, double) { return 0.16 * std::clamp(x, -4.0, 4.0); };
  addGround(ramp);
  EXPECT_LT(highestOn(GridGround(map), ramp), lowest_obstacle);
  map = {};
  const Surface crest = [](double x, double) { return -0.12 * std::abs(x); };
  addGround(crest);
  EXPECT_LT(highestOn(GridGround(map), crest), lowest_obstacle);
}

/** Walls, steps and edges of 0.5 m or more are not taken for a slope, on level ground or on one. */
TEST_F(GridGroundTest, WhatHangsOverHiddenGroundIsNotTheGround)
{
  addGround([](double x, double) { return x < 2 ? 0.0 : 4.0; });  // a floor, then a ceiling
  const GridGround ground(map, {{-5, 0, 1.7}});
  EXPECT_TRUE(ground.isSeenAt({-8, 0, 0}));
  EXPECT_TRUE(ground.isSeenAt({1.5, 0, 0}));
  for (double x = 4.5; x < 12; ++x)
  {
    EXPECT_FALSE(ground.isSeenAt({x, 0, 4})) << x;
  }
  EXPECT_FALSE(ground.isSeenAt({50, 0, 0})) << "off the map";
  const GridGround upstairs(map, {{8, 0, 5.7}});
  EXPECT_TRUE(upstairs.isSeenAt({8, 0, 4})) << "the lidar stands on it";
  EXPECT_TRUE(GridGround(map).isSeenAt({8, 0, 4})) << "without lidars";
}

TEST_F(GridGroundTest, AHillAboveTheLidarIsGround)
{
  addGround([](double x, double) { return 0.2 * x; });
  const GridGround ground(map, {{-11, 0, -0.5}});
  for (double x = -11.5; x < 12; ++x)
  {
    EXPECT_TRUE(ground.isSeenAt({x, 0, 0.2 * x})) << x;
  }
}

TEST_F(GridGroundTest, StepsStayObstacles)
{
  for (const double slope : {0.0, 0.1})
  {
    for (const double height : {0.5, 1.0, 2.0})
    {
      const Surface step = [&](double x, double y) { return slope * y + (x > 0.5 ? height : 0.0); };
      map = {};
      addGround(step);
      const GridGround ground(map);
      for (double y = -8; y < 8; y += 0.5)
      {
        EXPECT_GT(ground.above({0.6, y, step(0.6, y)}), lowest_obstacle) << height << " " << slope;
        EXPECT_LT(ground.above({0.4, y, step(0.4, y)}), 0.1) << height << " " << slope;
        EXPECT_LT(ground.above({6.5, y, step(6.5, y)}), 0.1) << height << " " << slope;
      }
    }
  }
}

TEST_F(GridGroundTest, SteeperBanksAreObstacles)
{
  const Surface bank = [](double x, double) { return x > 0 ? 0.7 * x : 0.0; };
  addGround(bank);
  const GridGround ground(map);
  EXPECT_LT(ground.above({-3.5, 0, 0}), 0.1);
  EXPECT_GT(ground.above({2.5, 0, bank(2.5, 0)}), lowest_obstacle);
}

/** As beside a street: on one side there are returns of a facade only. */
TEST_F(GridGroundTest, AFacadeLeavesTheStreetLevel)
{
  for (double y = -11.9; y < 12; y += 0.2)
  {
    for (double x = -3.9; x < 0; x += 0.2)
    {
      add(x, y, 0);
    }
    for (double z = 0.5 + std::abs(std::sin(y)); z < 4; z += 0.2)
    {
      add(0.1 + 0.3 * std::sin(5 * z), y, z);
    }
  }
  const GridGround ground(map);
  for (double y = -8; y < 8; y += 0.5)
  {
    EXPECT_NEAR(0, ground.above({-1, y, 0}), 0.05);
    EXPECT_NEAR(1.5, ground.above({0.1, y, 1.5}), 0.05);
  }
}

/** Multipath echoes below a slope, in one column of three, seen once or twice. */
TEST_F(GridGroundTest, EchoesBelowASlopeLeaveItFree)
{
  const Surface slope = [](double x, double) { return 0.15 * x; };
  for (const std::uint32_t hits : {1U, 2U})
  {
    map = {};
    addGround(slope);
    int count = 0;
    for (double x = -11.5; x < 12; ++x)
    {
      for (double y = -11.5; y < 12; ++y)
      {
        if (++count % (hits == 1 ? 3 : 5) == 0)
        {
          add(x, y, slope(x, y) - 0.8, hits);
        }
      }
    }
    EXPECT_LT(highestOn(GridGround(map), slope), 0.1) << hits;
  }
}

/** Rings of a sensor with 16 far away: a column in four has points, in lines. */
TEST_F(GridGroundTest, SparseColumnsOfASlopeAreFree)
{
  const Surface slope = [](double x, double y) { return 0.12 * x - 0.08 * y; };
  for (double x = -11.5; x < 12; x += 4)
  {
    for (double y = -11.5; y < 12; ++y)
    {
      add(x, y, slope(x, y));
    }
  }
  const GridGround ground(map);
  for (const Eigen::Vector3f& p : map.points)
  {
    EXPECT_LT(ground.above(p.cast<double>()), lowest_obstacle);
  }
}

TEST_F(GridGroundTest, FewPointsAreTheirOwnGround)
{
  EXPECT_TRUE(std::isnan(GridGround(map).above({0, 0, 0})));
  add(0.5, 0.5, 3);
  EXPECT_NEAR(1, GridGround(map).above({0.7, 0.3, 4}), 1e-6);
  add(1.5, 0.5, 3.2);
  EXPECT_NEAR(1, GridGround(map).above({0.7, 0.3, 4}), 1e-6);
}
}  // namespace
}  // namespace dyslam
