// SPDX-License-Identifier: BSD-3-Clause
#include "prior_map/PlaceSearch.h"

#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "BoxWorld.h"
#include "LocalisedRun.h"
#include "prior_map/PriorMap.h"

namespace dyslam
{
namespace
{
using test::BoxWorld;
using test::driveAround;
using test::mapOf;
using test::T_prior_world;

TEST(PlaceSearch, FindsPositionAndHeading)
{
  const BoxWorld world(31, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 150, 1.5);
  const PlaceSearch search(mapOf(world, drive));
  for (const std::size_t at : {10U, 37U, 80U})
  {
    const Pose T_vehicle_submap = poseFromYpr(0, 0, 0, 1.1, 0, 0);
    const Pose T_world_submap = drive[at] * T_vehicle_submap;
    std::vector<Eigen::Vector3f> submap;
    for (std::size_t i = at - 6; i <= at; ++i)
    {
      const Eigen::Isometry3f T = (T_world_submap.inverse() * drive[i]).cast<float>();
      for (const Eigen::Vector3f& p : world.scan(drive[i], static_cast<unsigned>(i)))
      {
        submap.emplace_back(T * p);
      }
    }
    const std::vector<SimilarPlace> found = search.find(submap);
    ASSERT_FALSE(found.empty());
    const Pose T_true = T_prior_world * T_world_submap;
    EXPECT_NEAR(found.front().x, T_true.translation().x(), 1.5);
    EXPECT_NEAR(found.front().y, T_true.translation().y(), 1.5);
    EXPECT_NEAR(std::remainder(found.front().heading - yawPitchRoll(T_true).x(), 2 * M_PI), 0,
                0.06);
    EXPECT_GT(found.front().score, 0.5);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                               [](const auto& a, const auto& b) { return a.score > b.score; }));
  }
}

TEST(PlaceSearch, StaysWithinAnArea)
{
  const BoxWorld world(31, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 150, 1.5);
  const PlaceSearch search(mapOf(world, drive));
  const std::vector<Eigen::Vector3f> points = world.scan(drive[37], 37);
  const Eigen::Vector2d at = (T_prior_world * drive[37]).translation().head<2>();
  const std::vector<SimilarPlace> around = search.find(points, SearchArea{at, 6});
  ASSERT_FALSE(around.empty());
  EXPECT_NEAR(around.front().x, at.x(), 1.5);
  EXPECT_NEAR(around.front().y, at.y(), 1.5);
  const Eigen::Vector2d aside = at + Eigen::Vector2d(-20, 10);
  const std::vector<SimilarPlace> elsewhere = search.find(points, SearchArea{aside, 6});
  EXPECT_FALSE(elsewhere.empty());
  for (const SimilarPlace& place : elsewhere)
  {
    EXPECT_NEAR(place.x, aside.x(), 7.1);
    EXPECT_NEAR(place.y, aside.y(), 7.1);
  }
  EXPECT_TRUE(search.find(points, SearchArea{at + Eigen::Vector2d(1000, 0), 6}).empty());
  EXPECT_TRUE(search.find(points, SearchArea{at - Eigen::Vector2d(1e9, 0), 6}).empty());
  const std::vector<SimilarPlace> all = search.find(points);
  const std::vector<SimilarPlace> wide = search.find(points, SearchArea{at, 1e9});
  ASSERT_EQ(all.size(), wide.size());
  EXPECT_EQ(all.front().x, wide.front().x);
  EXPECT_EQ(all.back().y, wide.back().y);
}

TEST(PlaceSearch, AStrayPointFarOffDoesNotMatter)
{
  const BoxWorld world(31, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 60, 1.5);
  std::vector<Eigen::Vector3f> map = mapOf(world, drive);
  map.emplace_back(-45000, 45000, 0);
  const std::vector<SimilarPlace> found = PlaceSearch(map).find(world.scan(drive[10], 10));
  ASSERT_FALSE(found.empty());
  const Pose T_true = T_prior_world * drive[10];
  EXPECT_NEAR(found.front().x, T_true.translation().x(), 1.5);
  EXPECT_NEAR(found.front().y, T_true.translation().y(), 1.5);
}

TEST(PlaceSearch, NothingIsSimilarToNothing)
{
  const std::vector<Eigen::Vector3f> wall{{1, 2, 0}, {1, 2, 2}};
  EXPECT_TRUE(PlaceSearch({}).find(wall).empty());
  EXPECT_TRUE(PlaceSearch(wall).find({}).empty());
  EXPECT_TRUE(PlaceSearch({{1, 2, 0}}).find(wall).empty()) << "the map has no upright structure";
  const Eigen::Vector3f nowhere = Eigen::Vector3f::Constant(NAN);
  EXPECT_TRUE(PlaceSearch({nowhere}).find(wall).empty());
  EXPECT_FALSE(PlaceSearch(wall).find(wall).empty());
}

TEST(PriorMap, KnowsTheGroundWhereItHasPoints)
{
  const BoxWorld world(32, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 60, 1.5);
  const PriorMap map(mapOf(world, drive), 50);
  const Eigen::Vector3d at = (T_prior_world * drive[10]).translation();
  ASSERT_TRUE(map.groundHeight(at.x(), at.y()));
  EXPECT_NEAR(*map.groundHeight(at.x(), at.y()), 12, 0.1);
  EXPECT_FALSE(map.groundHeight(at.x() + 1000, at.y()));
  EXPECT_TRUE(PriorMap({}, 50).empty());
}

TEST(PriorMap, FindsTheGroundAmongPoints)
{
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40; ++i)
  {
    points.emplace_back(5 + 0.05F * static_cast<float>(i), 7, i < 10 ? -2 : 1);
  }
  EXPECT_NEAR(groundAmong(points, 6, 7).value(), -2, 1e-6);
  EXPECT_FALSE(groundAmong(points, 6, 12)) << "4 m around";
  EXPECT_FALSE(groundAmong({points.begin(), points.begin() + 4}, 5, 7)) << "too few";
  points.emplace_back(6, 7, -50);
  EXPECT_NEAR(groundAmong(points, 6, 7).value(), -2, 1e-6) << "one point in ten may be lower";
}

TEST(PriorMap, HasTheSameTargetAfterItsStateWasLoaded)
{
  const BoxWorld world(39, 30, 20);
  const std::vector<Eigen::Vector3f> points = mapOf(world, driveAround(30, 20, 60, 1.5));
  const Eigen::Vector3d start = T_prior_world.translation() + Eigen::Vector3d(5, 5, 0);
  const Eigen::Vector3d further = start + Eigen::Vector3d(8, 0, 0);
  PriorMap map(points, 10);
  (void)map.around(start);
  StateArchive saved;
  map.exchangeState(saved);
  PriorMap loaded(points, 10);
  StateArchive archive(saved.bytes());
  loaded.exchangeState(archive);
  EXPECT_TRUE(loaded.around(further).points() == map.around(further).points());
  EXPECT_FALSE(PriorMap(points, 10).around(further).points() == map.around(further).points());
}
}  // namespace
}  // namespace dyslam
