// SPDX-License-Identifier: BSD-3-Clause
// A static map whose keyframes get other poses, as after a loop closure.
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
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

TEST(StaticMapCorrection, CorrectionToTheSamePosesChangesNothing)
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

TEST(StaticMapCorrection, FollowsCorrectedPosesWithWhatWasCleaned)
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

TEST(StaticMapCorrection, CorrectedHalfwayIsAsGoodAsStitchedAtTheEnd)
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

TEST(StaticMapCorrection, FollowsALoopBeforeTheNextKeyframeIfItIsWorthIt)
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

TEST(StaticMapCorrection, FollowsSmallCorrectionsOnceItHasGrown)
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

TEST(StaticMapCorrection, EachCorrectionKeepsThePoints)
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
}  // namespace
}  // namespace dyslam
