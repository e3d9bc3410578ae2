// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>

#include "TestMap.h"
#include "TestStreet.h"

namespace dyslam
{
namespace
{
using test::kNoCar;
using test::scanAt;
using test::TestMap;

std::size_t countIn(const MapPoints& map, const Eigen::Vector3f& low, const Eigen::Vector3f& high)
{
  std::size_t count = 0;
  for (const auto& p : map.points)
  {
    count += (p.array() >= low.array()).all() && (p.array() <= high.array()).all() ? 1 : 0;
  }
  return count;
}

std::size_t carPoints(const MapPoints& map)
{
  return countIn(map, {-20, -4.5F, 0.4F}, {80, -1.6F, 1.8F});
}

std::vector<Pose> posesOf(std::size_t count, double step)
{
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i)
  {
    poses.push_back(poseFromYpr(step * static_cast<double>(i), 0, 0, 0, 0, 0));
  }
  return poses;
}

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

TEST(StaticMap, OfThreeRunsTheLatestCounts)
{
  constexpr double there = 12;
  const auto latest = MapChanges::latest;
  const std::size_t parked = carPointsOfRuns({there, there, there}, latest);
  ASSERT_GT(parked, 100U);
  // The car is gone in the second run and back in the third.
  EXPECT_GT(carPointsOfRuns({there, kNoCar, there}, latest), parked * 4 / 5);
  EXPECT_LT(carPointsOfRuns({kNoCar, there, kNoCar}, latest), parked / 10);
}

TEST(StaticMap, OfTwoRunsTheLatestThatSawAPlaceCounts)
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

TEST(StaticMap, OfTwoRunsWhatWasCleanedStaysSoWhereVoxelsGrow)
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

TEST(StaticMap, CorrectionToTheSamePosesChangesNothing)
{
  TestMap map;
  for (std::size_t i = 0; i < 8; ++i)
  {
    map.insert(scanAt(i, static_cast<double>(i), 10 + 2.0 * static_cast<double>(i)));
  }
  const auto before = map.map.points();
  map.correct(posesOf(8, 1));
  const auto after = map.map.points();
  ASSERT_EQ(before.points.size(), after.points.size());
  EXPECT_EQ(before.points, after.points);
  EXPECT_EQ(before.intensity, after.intensity);
}

TEST(StaticMap, FollowsCorrectedPosesWithWhatWasCleaned)
{
  TestMap map;
  for (std::size_t i = 0; i < 12; ++i)
  {
    map.insert(scanAt(i, static_cast<double>(i), 12 + 2.0 * static_cast<double>(i)));
  }
  const std::size_t car_before = carPoints(map.map.points());
  std::vector<Pose> corrected = posesOf(12, 1);
  const Pose shift = poseFromYpr(100, 0, 0, 0, 0, 0);
  for (auto& pose : corrected)
  {
    pose = shift * pose;
  }
  const std::size_t count = map.map.points().size();
  map.correct(corrected);
  const auto moved = map.map.points();
  EXPECT_NEAR(static_cast<double>(moved.size()), static_cast<double>(count),
              0.02 * static_cast<double>(count));
  EXPECT_EQ(countIn(moved, {-100, -50, -5}, {30, 50, 10}), 0U);
  EXPECT_LE(countIn(moved, {80, -4.5F, 0.4F}, {180, -1.6F, 1.8F}),
            car_before + car_before / 10 + 5);
}

/** Share of the points of `a` that lie within a voxel of a point of `b`. */
double shareNear(const MapPoints& a, const MapPoints& b, double voxel_size)
{
  VoxelHash cells;
  const auto inverse = static_cast<float>(1 / voxel_size);
  for (const auto& p : b.points)
  {
    cells.findOrInsert(voxelKey(voxelCell(p, inverse)), 0);
  }
  std::size_t met = 0;
  for (const auto& p : a.points)
  {
    bool found = false;
    const VoxelCell c = voxelCell(p, inverse);
    for (int k = 0; k < 27 && !found; ++k)
    {
      const VoxelCell near{c.x + k % 3 - 1, c.y + k / 3 % 3 - 1, c.z + k / 9 - 1};
      found = cells.find(voxelKey(near)) != VoxelHash::none;
    }
    met += found ? 1 : 0;
  }
  return static_cast<double>(met) / static_cast<double>(a.size());
}

TEST(StaticMap, CorrectedHalfwayIsAsGoodAsStitchedAtTheEnd)
{
  // The street up and down again with an odometry that drifts sideways and turns; a loop closes
  // halfway back. Later scans are at their true poses.
  constexpr std::size_t count = 24;
  constexpr std::size_t closed = 18;
  std::vector<Frame> frames;
  std::vector<Pose> truth;
  std::vector<Pose> odometry;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double x = static_cast<double>(i < count / 2 ? i : count - 1 - i);
    frames.push_back(scanAt(i, x, kNoCar));
    truth.push_back(poseFromYpr(x, 0, 0, 0, 0, 0));
    const double drift = static_cast<double>(i) / count;
    odometry.push_back(truth.back() * poseFromYpr(0, 1.5 * drift, 0.2 * drift, 0.02 * drift, 0, 0));
  }
  const auto run = [&](const std::function<void(TestMap&, std::size_t)>& before_insert)
  {
    TestMap map;
    for (std::size_t i = 0; i < count; ++i)
    {
      frames[i].T_odom_vehicle = odometry[i];
      before_insert(map, i);
      map.insert(frames[i]);
    }
    return map;
  };
  TestMap at_end = run([](TestMap&, std::size_t) {});
  const double drifted_size = static_cast<double>(at_end.map.points().size());
  at_end.correct(truth);
  const TestMap halfway = run(
      [&](TestMap& map, std::size_t i)
      {
        const auto part = static_cast<std::ptrdiff_t>(i);
        if (i == closed)
        {
          map.correct({truth.begin(), truth.begin() + part});
        }
        frames[i].T_odom_vehicle = i < closed ? odometry[i] : truth[i];
      });
  const TestMap perfect =
      run([&](TestMap&, std::size_t i) { frames[i].T_odom_vehicle = truth[i]; });

  const MapPoints expected = perfect.map.points();
  const auto size = static_cast<double>(expected.size());
  EXPECT_GT(drifted_size, 1.3 * size);  // the drifted map has everything twice
  for (const TestMap* map : {static_cast<const TestMap*>(&at_end), &halfway})
  {
    const MapPoints found = map->map.points();
    EXPECT_NEAR(static_cast<double>(found.size()), size, 0.05 * size);
    EXPECT_GT(shareNear(found, expected, 0.2), 0.995);
    EXPECT_GT(shareNear(expected, found, 0.2), 0.995);
  }
  const MapPoints a = at_end.map.points();
  const MapPoints b = halfway.map.points();
  EXPECT_NEAR(static_cast<double>(a.size()), static_cast<double>(b.size()), 0.03 * size);
  EXPECT_GT(shareNear(a, b, 0.2), 0.999);
  EXPECT_GT(shareNear(b, a, 0.2), 0.999);
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

TEST(StaticMap, FollowsALoopBeforeTheNextKeyframeIfItIsWorthIt)
{
  for (const double shift : {0.04, 0.4})
  {
    TestMap map;
    for (std::size_t i = 0; i < 2; ++i)
    {
      map.insert(scanAt(i, static_cast<double>(i), kNoCar));
    }
    std::vector<Pose> corrected = posesOf(2, 1);
    corrected[1].translation().y() += shift;
    map.keyframes->correct(corrected);
    map.insert(scanAt(2, 2, kNoCar));
    EXPECT_NEAR(map.map.poses()[1].translation().y(), shift > 0.05 ? shift : 0, 1e-12);
    map.map.correct();  // at the end of a run every correction counts
    EXPECT_NEAR(map.map.poses()[1].translation().y(), shift, 1e-12);
  }
}

TEST(StaticMap, FollowsSmallCorrectionsOnceItHasGrown)
{
  TestMap map;
  const auto insert = [&map](std::size_t i)
  { map.insert(scanAt(i, static_cast<double>(i), kNoCar)); };
  for (std::size_t i = 0; i < 20; ++i)
  {
    insert(i);
  }
  std::vector<Pose> corrected = posesOf(20, 1);
  corrected[5].translation().y() = 0.4;
  map.keyframes->correct(corrected);
  insert(20);
  ASSERT_NEAR(map.map.poses()[5].translation().y(), 0.4, 1e-12);
  corrected = posesOf(21, 1);
  corrected[5].translation().y() = 0.5;
  map.keyframes->correct(corrected);
  insert(21);
  EXPECT_NEAR(map.map.poses()[5].translation().y(), 0.4, 1e-12) << "less than a voxel: it may wait";
  insert(22);
  EXPECT_NEAR(map.map.poses()[5].translation().y(), 0.5, 1e-12) << "a tenth more keyframes";
}

TEST(StaticMap, EachCorrectionKeepsThePoints)
{
  // Poses that tremble at every optimisation must not wear the map out.
  TestMap map;
  for (std::size_t i = 0; i < 8; ++i)
  {
    map.insert(scanAt(i, static_cast<double>(i), kNoCar));
  }
  const auto before = static_cast<double>(map.map.points().size());
  const std::size_t stored = map.pointCount();
  for (int k = 1; k <= 20; ++k)
  {
    std::vector<Pose> poses = posesOf(8, 1);
    for (std::size_t i = 0; i < poses.size(); ++i)
    {
      poses[i].translation().y() += 0.05 * std::sin(k * static_cast<double>(i));
    }
    map.correct(poses);
  }
  map.correct(posesOf(8, 1));
  EXPECT_NEAR(static_cast<double>(map.map.points().size()), before, 0.01 * before);
  EXPECT_GT(map.pointCount(), stored * 8 / 10);
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
