// SPDX-License-Identifier: BSD-3-Clause
// A static map of several runs of one place.
#include <dyslam/mapping/StaticMap.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "TestMap.h"
#include "TestStreet.h"

namespace dyslam
{
namespace
{
using test::carPoints;
using test::countIn;
using test::kNoCar;
using test::scanAt;
using test::TestMap;

/** Number of car points in the map of a street driven along several times. \param cars x of the
 * parked car in each run [m] */
std::size_t carPointsOfRuns(const std::vector<double>& cars, MapChanges changes, int min_hits = 1)
{
  StaticMapOptions options;
  options.changes = changes;
  options.min_hits = min_hits;
  TestMap map(options);
  for (const double car : cars)
  {
    if (!map.keyframes->empty())
    {
      map.map.beginRun();
    }
    for (std::size_t i = 0; i < 12; ++i)
    {
      map.insert(scanAt(i, static_cast<double>(i) * 0.8, car));
    }
  }
  return carPoints(map.map.points());
}

/** carPointsOfRuns() of two runs. \param first, second x of the parked car in each run [m] */
std::size_t carPointsOfTwoRuns(double first, double second, MapChanges changes, int min_hits = 1)
{
  return carPointsOfRuns({first, second}, changes, min_hits);
}

TEST(StaticMapRuns, OfThreeRunsTheLatestCounts)
{
  constexpr double there = 12;
  const auto latest = MapChanges::latest;
  const std::size_t parked = carPointsOfRuns({there, there, there}, latest);
  ASSERT_GT(parked, 100U);
  // The car is gone in the second run and back in the third.
  EXPECT_GT(carPointsOfRuns({there, kNoCar, there}, latest), parked * 4 / 5);
  EXPECT_LT(carPointsOfRuns({kNoCar, there, kNoCar}, latest), parked / 10);
}

TEST(StaticMapRuns, OfTwoRunsTheLatestThatSawAPlaceCounts)
{
  constexpr double there = 12;
  const std::size_t parked = carPointsOfTwoRuns(there, there, MapChanges::latest);
  ASSERT_GT(parked, 100U);
  EXPECT_EQ(carPointsOfTwoRuns(there, there, MapChanges::all), parked);
  EXPECT_LT(carPointsOfTwoRuns(there, kNoCar, MapChanges::latest), parked / 10);
  EXPECT_GT(carPointsOfTwoRuns(there, kNoCar, MapChanges::all), parked / 4);
  EXPECT_GT(carPointsOfTwoRuns(kNoCar, there, MapChanges::latest), parked / 2);
  EXPECT_EQ(carPointsOfTwoRuns(there, there, MapChanges::latest, 3),
            carPointsOfTwoRuns(there, there, MapChanges::all, 3));
}

/** Scan of a sensor at rest: a wall in front, 400 voxels of 0.2 m. \param ghost whether
 * something stood in between \param behind whether there is a wall of 1600 voxels behind */
Frame standingScan(std::size_t index, bool ghost, bool behind)
{
  Frame frame;
  frame.index = index;
  const auto add = [&](float x, float y, float z)
  {
    frame.cloud.points.emplace_back(x, y, z);
    frame.cloud.source.push_back(0);
  };
  for (int i = 0; i < 1600; ++i)
  {
    const auto column = static_cast<float>(i % 40);
    const auto row = static_cast<float>(i / 40);
    add(20.1F, 0.1F * column - 1.95F, 0.1F * row - 1.95F);
    if (behind)
    {
      add(-10.1F, 0.2F * column - 3.9F, 0.2F * row - 1.5F);
    }
  }
  add(10.1F, 0.1F, -1.7F);  // the ground
  if (ghost)
  {
    add(10.1F, 0.1F, 0.1F);
  }
  return frame;
}

TEST(StaticMapRuns, OfTwoRunsWhatWasCleanedStaysSoWhereVoxelsGrow)
{
  for (const int max_voxels : {1000000000, 1000})
  {
    StaticMapOptions options;
    options.max_voxels = max_voxels;
    TestMap map(options);
    for (std::size_t k = 0; k < 17; ++k)
    {
      if (k == 8)
      {
        map.map.beginRun();
      }
      map.insert(standingScan(k, k % 8 < 2 && k < 16, k == 16));
    }
    EXPECT_EQ(max_voxels > 1000 ? 0.2 : 0.4, map.map.voxelSize());
    const MapPoints points = map.map.points();
    EXPECT_EQ(0U, countIn(points, {9.9F, -0.1F, -0.1F}, {10.3F, 0.3F, 0.3F})) << max_voxels;
    EXPECT_EQ(1U, countIn(points, {9.9F, -0.1F, -1.9F}, {10.3F, 0.3F, -1.5F})) << max_voxels;
    EXPECT_GE(countIn(points, {19.9F, -2, -2}, {20.3F, 2, 2}), 100U) << max_voxels;
  }
}
}  // namespace
}  // namespace dyslam
