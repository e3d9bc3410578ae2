// SPDX-License-Identifier: BSD-3-Clause
// Which cells of an occupancy grid are obstacles: what stands on the ground, seen often enough.
#include <dyslam/mapexport/MapExport.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "ReadGrid.h"
#include "TestFolder.h"
#include "TestMap.h"

namespace dyslam
{
namespace
{
/** One keyframe sees a post 1 m high at x = 3, all of them one at x = 5. */
test::TestMap twoPosts(std::size_t keyframes)
{
  test::TestMap map;
  for (std::size_t k = 0; k < keyframes; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    const auto add = [&](float x, float y, float z)
    {
      frame.cloud.points.emplace_back(x, y, z);
      frame.cloud.intensity.push_back(0.25F);
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 6400; ++i)  // floor of 8 m by 8 m
    {
      add(0.1F * static_cast<float>(i % 80) + 0.05F, 0.1F * static_cast<float>(i / 80) - 3.95F,
          0.02F);
    }
    for (float z = 0.5F; z < 1; z += 0.1F)
    {
      add(5.05F, 0.05F, z);
      if (k == 0)
      {
        add(3.05F, 0.05F, z);
      }
    }
    map.insert(frame);
  }
  return map;
}

TEST(GridObstacles, ObstaclesOfTheGridAreSeenByTwoKeyframes)
{
  const TestFolder folder;
  const auto occupied = [&](std::size_t keyframes, int min_hits, double x)
  {
    MapExportOptions options;
    options.obstacle_min_hits = min_hits;
    writeOccupancyGrid(twoPosts(keyframes).map, folder.file("m.gridmap"), options);
    const auto grid = test::readGridmap(folder.file("m.gridmap"));
    return grid.getPos(static_cast<float>(x), 0.05F) < 0.4F;
  };
  EXPECT_TRUE(occupied(3, 1, 3.05));
  EXPECT_FALSE(occupied(3, 2, 3.05)) << "seen once";
  EXPECT_TRUE(occupied(3, 2, 5.05));
  EXPECT_TRUE(occupied(1, 2, 3.05)) << "there is but one keyframe";
}

/** Multipath echoes lie below the road; a quarter of the columns with one is no obstacle. */
TEST(GridObstacles, EchoesBelowTheRoadLeaveItFree)
{
  const TestFolder folder;
  test::TestMap map;
  for (std::size_t k = 0; k < 3; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    const auto add = [&](double x, double y, double z)
    {
      frame.cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                      static_cast<float>(z));
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 6400; ++i)  // road of 8 m by 8 m
    {
      add(0.1 * (i % 80) + 0.05, 0.1 * (i / 80) - 3.95, 0.02);
    }
    for (int i = 0; k == 1 && i < 64; ++i)  // an echo in every second column, seen once
    {
      if (i % 2 == 0)
      {
        add(i % 8 + 0.55, i / 8 - 3.45, -0.8);
      }
    }
    map.insert(frame);
  }
  writeOccupancyGrid(map.map, folder.file("m.gridmap"), MapExportOptions());
  const auto grid = test::readGridmap(folder.file("m.gridmap"));
  for (float x = 0.55F; x < 7.5F; x += 0.1F)
  {
    EXPECT_GT(grid.getPos(x, 0.05F), 0.4F) << x;
  }
}

/** A ramp of 12 degrees with a box on it. */
TEST(GridObstacles, RampsAreFreeAndWhatStandsOnThemIsNot)
{
  const TestFolder folder;
  test::TestMap map;
  for (std::size_t k = 0; k < 3; ++k)
  {
    Frame frame;
    frame.index = k;
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    const auto add = [&](double x, double y, double height)
    {
      frame.cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                      static_cast<float>(std::tan(12 * M_PI / 180) * x + height));
      frame.cloud.source.push_back(0);
    };
    for (int i = 0; i < 10000; ++i)  // 10 m by 10 m
    {
      add(3.05 + 0.1 * (i % 100), 0.1 * (i / 100) - 4.95, 0);
    }
    for (double y = 1.05; y < 2; y += 0.1)
    {
      for (double height = 0.2; height < 1; height += 0.1)
      {
        add(7.05, y, height);
      }
    }
    map.insert(frame);
  }
  writeOccupancyGrid(map.map, folder.file("m.gridmap"), MapExportOptions());
  const auto grid = test::readGridmap(folder.file("m.gridmap"));
  int occupied = 0;
  for (float y = -4.45F; y < 4.5F; y += 0.1F)
  {
    for (float x = 3.55F; x < 12.5F; x += 0.1F)
    {
      const bool is_box = std::abs(x - 7.05F) < 0.3F && std::abs(y - 1.5F) < 0.7F;
      const bool is_occupied = grid.getPos(x, y) < 0.4F;
      EXPECT_TRUE(is_box || !is_occupied) << x << " " << y;
      occupied += is_occupied ? 1 : 0;
    }
  }
  EXPECT_GE(occupied, 4);
}
}  // namespace
}  // namespace dyslam
