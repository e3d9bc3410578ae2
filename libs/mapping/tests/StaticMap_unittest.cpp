// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <stdexcept>
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
using test::posesOf;
using test::scanAt;
using test::TestMap;

TEST(StaticMap, KeyframesThatArePassedOverLeaveNoPoints)
{
  TestMap map;
  Frame frame;
  frame.cloud.points = {{5, 0, 0}};
  map.insert(frame);
  Frame unregistered;
  unregistered.cloud.points = {{10, 0, 0}};
  map.keyframes->add(keyframeOf(unregistered));
  map.map.insertWithoutPoints(unregistered);
  EXPECT_EQ(map.map.points().size(), 1U);
  frame.cloud.points = {{15, 0, 0}};
  map.insert(frame);
  EXPECT_EQ(map.map.points().size(), 2U);
  map.correct(posesOf(3, 1));
  EXPECT_EQ(map.map.points().size(), 2U);
  EXPECT_EQ(map.map.keyframes().size(), 3U);
}

TEST(StaticMap, RefusesAnEmptyRange)
{
  StaticMapOptions options;
  options.min_range = options.max_range = 20;
  EXPECT_THROW(TestMap{options}, UserError);
}

TEST(StaticMap, EmptyOnePointAndNotFinite)
{
  TestMap map;
  EXPECT_EQ(map.map.points().size(), 0U);
  map.correct({});
  Frame empty;
  map.insert(empty);
  Frame one;
  one.cloud.points = {{5, 0, 0},
                      {std::numeric_limits<float>::quiet_NaN(), 0, 0},
                      {std::numeric_limits<float>::infinity(), 0, 0}};
  map.insert(one);
  Frame lost = one;
  lost.T_odom_vehicle.translation().x() = std::numeric_limits<double>::quiet_NaN();
  map.insert(lost);
  ASSERT_EQ(map.map.points().size(), 1U);
  EXPECT_LT((map.map.points().points[0] - Eigen::Vector3f(5, 0, 0)).norm(), 0.004F);
  EXPECT_EQ(map.map.keyframes().size(), 3U);
  EXPECT_THROW(map.map.insert(one), std::invalid_argument);  // not a new keyframe
  map.correct(posesOf(3, 1));
  ASSERT_EQ(map.map.points().size(), 1U);
  EXPECT_NEAR(map.map.points().points[0].x(), 6, 0.004F);
}

TEST(StaticMap, PosesTooFarAwayToCountVoxelsLeaveTheOthersAlone)
{
  TestMap map;
  Frame frame;
  frame.cloud.points = {{5, 0, 0}, {6, 0, 1}};
  map.insert(frame);
  for (const double far : {1e9, -1e12, 1e30, -1e300})
  {
    frame.T_odom_vehicle.translation().setConstant(far);
    map.insert(frame);
  }
  EXPECT_EQ(map.map.voxelAt({5, NAN, 1e300}), VoxelHash::none);
  const MapPoints points = map.map.points();
  ASSERT_GE(points.size(), 2U);
  EXPECT_NEAR(points.points[0].x(), 5, 0.01F);
  EXPECT_NEAR(points.points[1].x(), 6, 0.01F);
}

TEST(StaticMap, LeavesOutMovingPointsAndTracks)
{
  Frame frame;
  frame.cloud.points = {{5, 0, 1}, {6, 0, 1}, {7, 0, 1}, {8, 0, 1}};
  frame.cloud.source = {0, 1, 2, 3};
  frame.moving = {true, true, false, false};
  TrackedObject by_box;
  by_box.dynamic = true;
  by_box.box.centre = {7, 0, 1};
  by_box.box.size = {0.5, 0.5, 1};
  TrackedObject parked = by_box;
  parked.dynamic = false;
  parked.box.centre = {8, 0, 1};
  frame.objects = {by_box, parked};
  TestMap map;
  map.insert(frame);
  ASSERT_EQ(map.map.points().size(), 1U);
  EXPECT_NEAR(map.map.points().points[0].x(), 8, 0.01F);
  EXPECT_EQ(map.pointCount(), 4U);  // moving points stay with their keyframe
}

TEST(StaticMap, RemovesWhatDroveAwayAndKeepsWallsGroundAndPole)
{
  StaticMapOptions without;
  without.visibility = false;
  TestMap cleaned;
  TestMap raw(without);
  for (std::size_t i = 0; i < 16; ++i)
  {
    const double x = static_cast<double>(i) * 0.8;
    const Frame frame = scanAt(i, x, 12 + 2.0 * static_cast<double>(i));
    cleaned.insert(frame);
    raw.insert(frame);
  }
  const auto before = raw.map.points();
  const auto after = cleaned.map.points();
  ASSERT_GT(carPoints(before), 300U);
  EXPECT_LT(carPoints(after), carPoints(before) / 4);

  const auto part = [&](const MapPoints& m, const Eigen::Vector3f& low, const Eigen::Vector3f& high)
  { return static_cast<double>(countIn(m, low, high)); };
  const Eigen::Vector3f pole_low(9.7F, 2.7F, 0.3F);
  const Eigen::Vector3f pole_high(10.3F, 3.3F, 6);
  ASSERT_GT(part(before, pole_low, pole_high), 5);
  EXPECT_EQ(part(after, pole_low, pole_high), part(before, pole_low, pole_high));
  for (const float wall : {-8.0F, 8.0F})
  {
    const Eigen::Vector3f low(-60, wall - 0.3F, 0.3F);
    const Eigen::Vector3f high(80, wall + 0.3F, 6);
    EXPECT_GT(part(after, low, high), 0.995 * part(before, low, high));
  }
  const Eigen::Vector3f ground_low(-60, -7.5F, -0.2F);
  const Eigen::Vector3f ground_high(80, 7.5F, 0.2F);
  EXPECT_EQ(part(after, ground_low, ground_high), part(before, ground_low, ground_high));
}

TEST(StaticMap, KeepsAParkedCar)
{
  TestMap map;
  StaticMapOptions without;
  without.visibility = false;
  TestMap raw(without);
  for (std::size_t i = 0; i < 12; ++i)
  {
    const Frame frame = scanAt(i, 0.8 * static_cast<double>(i), 14);
    map.insert(frame);
    raw.insert(frame);
  }
  EXPECT_GT(static_cast<double>(carPoints(map.map.points())),
            0.97 * static_cast<double>(carPoints(raw.map.points())));
}

TEST(StaticMap, PartlyOnDiskItIsTheSame)
{
  MemoryLimit tiny;
  tiny.file = std::make_shared<SwapFile>(testing::TempDir());
  tiny.bytes = 1000;
  StaticMapOptions options;
  options.visibility_min_views = 2;
  TestMap on_disk(options, tiny);
  TestMap in_memory(options);
  for (TestMap* map : {&on_disk, &in_memory})
  {
    constexpr std::size_t count = 12;
    for (std::size_t i = 0; i < count; ++i)
    {
      map->insert(scanAt(i, static_cast<double>(i), i < 3 ? 8 : kNoCar));
    }
    std::vector<Pose> corrected = posesOf(count, 1);
    for (std::size_t i = 6; i < count; ++i)
    {
      corrected[i].translation().y() += 0.3;
    }
    map->correct(corrected);
  }
  const MapPoints a = on_disk.map.points();
  const MapPoints b = in_memory.map.points();
  EXPECT_GT(a.size(), 1000U);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.hits, b.hits);
  EXPECT_EQ(a.voxel, b.voxel);
  EXPECT_EQ(a.keyframe, b.keyframe);
  EXPECT_TRUE(std::is_sorted(a.voxel.begin(), a.voxel.end()));
  EXPECT_EQ(on_disk.pointCount(), in_memory.pointCount());
  EXPECT_GT(tiny.file->size(), 10 * on_disk.map.memory());
}

TEST(StaticMap, MemoryIsBoundedByAreaNotByTime)
{
  TestMap map;
  const auto drive = [&](std::size_t rounds)
  {
    for (std::size_t i = 0; i < rounds; ++i)
    {
      map.insert(scanAt(i, static_cast<double>(i % 4), kNoCar));
    }
  };
  drive(24);
  const std::size_t voxels = map.map.voxelCount();
  const std::size_t points = map.pointCount();
  drive(24);
  EXPECT_EQ(map.map.voxelCount(), voxels);
  EXPECT_LE(map.pointCount(), points + points / 50);
  EXPECT_LE(map.pointCount(), 5 * map.map.voxelCount());
}

TEST(StaticMap, VoxelsGrowWhereTheMapGetsTooLarge)
{
  StaticMapOptions options;
  options.max_voxels = 2000;
  TestMap map(options);
  for (std::size_t i = 0; i < 4; ++i)
  {
    map.insert(scanAt(i, 3.0 * static_cast<double>(i), kNoCar));
  }
  EXPECT_LE(map.map.voxelCount(), 2000U);
  EXPECT_GT(map.map.voxelSize(), 0.2);
  EXPECT_GT(map.map.points().size(), 300U);
}

TEST(StaticMap, StaticCloudsAreTheMap)
{
  TestMap map;
  for (std::size_t i = 0; i < 6; ++i)
  {
    map.insert(scanAt(i, static_cast<double>(i), 10 + 2.0 * static_cast<double>(i)));
  }
  std::size_t points = 0;
  std::size_t calls = 0;
  map.map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        EXPECT_EQ(k, calls++);
        points += cloud.size();
      });
  EXPECT_EQ(calls, 6U);
  EXPECT_GE(points, map.map.points().size());
  EXPECT_LE(points, map.pointCount());
}

TEST(StaticMapOptions, SaveLoadAndBadValues)
{
  StaticMapOptions options;
  options.voxel_size = 0.35;
  options.visibility = false;
  Config config;
  save(options, config, "map");
  StaticMapOptions back;
  load(back, Config::fromText(config.toIni(), "test.ini"), "map");
  EXPECT_EQ(back.voxel_size, 0.35);
  EXPECT_FALSE(back.visibility);
  options.voxel_size = -1;
  EXPECT_THROW(TestMap{options}, UserError);
}
}  // namespace
}  // namespace dyslam
