// SPDX-License-Identifier: BSD-3-Clause
// Runs that know their place on the earth or the vertical, merged.
#include <dyslam/backend/RunMerger.h>
#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/base/Angle.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "BoxWorld.h"
#include "MergedRuns.h"

namespace dyslam
{
namespace
{
using test::BoxWorld;
using test::driveAround;
using test::errorBetween;
using test::merged;
using test::OverlappingRuns;
using test::part;
using test::TestRun;

/** Where the origin of the world is on the earth; its x axis points to the east. */
const GeodeticPosition world_origin{49, 8.4, 115};

/** The run knows where its map begins on the earth. \param east error of that [m] */
void georeference(TestRun& run, double east = 0)
{
  Georeference found;
  found.origin = world_origin;
  found.T_enu_map = Eigen::Translation3d(east, 0, 0) * run.truth.front();
  found.fixes = 10;
  found.horizontal_rmse = 0.3;
  found.vertical_rmse = 0.5;
  run.references.georeference = found;
}

/** As georeference(), with exact positions in the run's graph.
 * \param origin of the axes of the positions */
void fusePositions(TestRun& run, const GeodeticPosition& origin)
{
  const Eigen::Vector3d lever_arm(0.3, -0.2, 1);
  Georeference found;
  found.origin = origin;
  found.T_enu_map = enuInEnu(world_origin, origin) * run.truth.front();
  found.fused = true;
  run.graph.addPose(Key::georeference(), found.T_enu_map);
  Matrix6 information = Matrix6::Identity();
  information(3, 3) = information(4, 4) = 100;
  for (std::size_t k = 0; k < run.truth.size(); k += 4)
  {
    run.graph.add(std::make_unique<GnssFactor>(
        k, toEnu(fromEnu(run.truth[k] * lever_arm, world_origin), origin), lever_arm, information));
    ++found.fixes;
  }
  run.references.georeference = found;
}

/** Largest distance of the run's merged poses on the earth from the true ones [m]. */
double errorOnEarth(const RunMerge& merge, const TestRun& run, std::size_t number)
{
  const Georeference& found = *merge.georeference;
  double worst = 0;
  for (std::size_t k = 0; k < run.truth.size(); ++k)
  {
    const Eigen::Vector3d enu = found.T_enu_map * merge.poses[number][k].translation();
    worst = std::max(
        worst,
        (toEnu(fromEnu(enu, found.origin), world_origin) - run.truth[k].translation()).norm());
  }
  return worst;
}

/** Rotates the run's map, which was level, by yaw, pitch and roll [deg], and lets the run have
 * measured the vertical. */
void tilt(TestRun& run, double yaw, double pitch, double roll)
{
  const Pose T = poseFromYpr(0, 0, 0, radians_per_degree * yaw, radians_per_degree * pitch,
                             radians_per_degree * roll);
  for (std::size_t k = 0; k < run.truth.size(); ++k)
  {
    run.graph.setPose(Key::ego(k), orthonormalised(T * run.graph.pose(Key::ego(k))));
  }
  Gravity gravity;
  gravity.up_map = T.linear().col(2);
  gravity.tilt = std::acos(gravity.up_map.z());
  gravity.tilt_sigma = 0.3 * radians_per_degree;
  gravity.directions = 5;
  run.references.gravity = gravity;
}

/** Gravity at every keyframe in the run's graph, with the accelerometer's bias. */
void fuseGravity(TestRun& run, const Eigen::Vector3d& bias)
{
  constexpr double sigma = 0.3 * radians_per_degree;
  constexpr double bias_sigma = 0.1;  // [m/s^2]
  Gravity& gravity = *run.references.gravity;
  gravity.fused = true;
  Pose T_level_map = Pose::Identity();
  T_level_map.linear() =
      Eigen::AngleAxisd(gravity.tilt, gravity.up_map.cross(Eigen::Vector3d::UnitZ()).normalized())
          .toRotationMatrix();
  run.graph.addPose(Key::vertical(), T_level_map);
  run.graph.addVector(Key::accelerometerBias(), Vector6::Zero());
  Matrix6 information = Matrix6::Identity();
  information.diagonal().head<2>().setConstant(1 / (sigma * sigma));
  information.diagonal().segment<3>(2).setConstant(
      1 / (bias_sigma * bias_sigma * static_cast<double>(run.truth.size())));
  for (std::size_t k = 0; k < run.truth.size(); ++k)
  {
    const Eigen::Matrix3d R_map_vehicle = run.graph.pose(Key::ego(k)).linear();
    run.graph.add(std::make_unique<GravityFactor>(
        k, standard_gravity * (R_map_vehicle.transpose() * gravity.up_map) + bias, information));
  }
}

/** Angle between two directions [deg]. */
double degreesBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  return degrees_per_radian * std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(RunMergerReferences, WithoutReferencesTheMergeHasNone)
{
  const OverlappingRuns overlapping;
  const auto& [first, second] = overlapping;
  const RunMerge merge = merged({&first, &second});
  EXPECT_FALSE(merge.georeference);
  EXPECT_FALSE(merge.gravity);
  ASSERT_EQ(merge.fits.size(), 2U);
  EXPECT_EQ(merge.fits[1].positions, 0U);
  EXPECT_FALSE(merge.fits[1].up_error);
}

TEST(RunMergerReferences, OneGeoreferencedRunPlacesTheMapOnTheEarth)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  georeference(second);
  for (const auto& runs : {std::vector<const TestRun*>{&first, &second}, {&second, &first}})
  {
    const RunMerge merge = merged(runs);
    ASSERT_TRUE(merge.joined(1));
    ASSERT_TRUE(merge.georeference);
    EXPECT_TRUE(merge.poses[0][0].isApprox(Pose::Identity(), 1e-9)) << "the first run's map frame";
    EXPECT_EQ(merge.georeference->fixes, 10U);
    EXPECT_EQ(merge.georeference->epsg, 32632);
    EXPECT_FALSE(merge.georeference->fused);
    EXPECT_LT(errorOnEarth(merge, *runs[0], 0), 1.5);
    EXPECT_LT(errorOnEarth(merge, *runs[1], 1), 1.5);
    EXPECT_LT(errorBetween(merge, runs, 0, 1), 0.08);
    const std::size_t of_second = runs[0] == &second ? 0 : 1;
    EXPECT_EQ(merge.fits[of_second].positions, 10U);
    EXPECT_NEAR(merge.fits[of_second].horizontal_rmse, 0.3, 0.2);
    EXPECT_EQ(merge.fits[1 - of_second].positions, 0U);
  }
}

TEST(RunMergerReferences, SatellitePositionsOfRunsWithDifferentOriginsAreFused)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  const GeodeticPosition origin = fromEnu({40, -25, 3}, world_origin);
  fusePositions(first, origin);
  fusePositions(second, fromEnu({-900, 700, -20}, world_origin));
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  ASSERT_TRUE(merge.georeference);
  EXPECT_EQ(merge.georeference->origin.latitude, origin.latitude) << "that of the first run";
  EXPECT_EQ(merge.georeference->fixes, 30U);
  EXPECT_TRUE(merge.georeference->fused);
  EXPECT_LT(merge.georeference->horizontal_rmse, 0.3);
  EXPECT_LT(merge.georeference->vertical_rmse, 0.5);
  EXPECT_LT(errorOnEarth(merge, first, 0), 0.7);
  EXPECT_LT(errorOnEarth(merge, second, 1), 0.7);
}

TEST(RunMergerReferences, SatellitePositionsTellPlacesApartThatLookAlike)
{
  const BoxWorld world = BoxWorld::square(21, 30);
  const std::vector<Pose> drive = driveAround(30, 30, 225, 1.5);
  TestRun round(world, drive, 12);
  TestRun side(world, part(drive, 5, 28), 13);
  georeference(round);
  georeference(side);
  const RunMerge merge = merged({&round, &side});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_LT(errorOnEarth(merge, side, 1), 2);
  RunMergerConfig without;
  without.merge.gnss = false;
  const RunMerge refused = merged({&round, &side}, without);
  EXPECT_FALSE(refused.joined(1));
  EXPECT_FALSE(refused.georeference);
}

TEST(RunMergerReferences, LoopsThatContradictSatellitePositionsJoinNoRun)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  georeference(first);
  georeference(second, 300);
  const RunMerge merge = merged({&first, &second});
  EXPECT_FALSE(merge.joined(1));
  ASSERT_TRUE(merge.evidence[1].contradiction);
  EXPECT_EQ(merge.evidence[1].contradiction->run, 0U);
  EXPECT_NEAR(merge.evidence[1].contradiction->distance, 300, 3);
  EXPECT_LT(merge.evidence[1].contradiction->tolerated, 20);
  ASSERT_TRUE(merge.evidence[1].distance);
  EXPECT_GT(*merge.evidence[1].distance, 200);
  ASSERT_TRUE(merge.georeference) << "of the first run";
  EXPECT_EQ(merge.georeference->fixes, 10U);
  RunMergerConfig without;
  without.merge.gnss = false;
  EXPECT_TRUE(merged({&first, &second}, without).joined(1));
}

TEST(RunMergerReferences, TwoTiltedRunsGiveOneVertical)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  tilt(first, 0, 8, -3);
  tilt(second, 20, -6, 5);
  const Eigen::Vector3d up = first.references.gravity->up_map;
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.08);
  EXPECT_TRUE(merge.poses[0][0].isApprox(first.graph.pose(Key::ego(0)), 1e-9));
  ASSERT_TRUE(merge.gravity);
  EXPECT_LT(degreesBetween(merge.gravity->up_map, up), 0.5);
  EXPECT_NEAR(merge.gravity->tilt, std::acos(up.z()), 0.5 * radians_per_degree);
  EXPECT_NEAR(merge.gravity->tilt_sigma, 0.3 * radians_per_degree / std::sqrt(2.0), 1e-6);
  EXPECT_EQ(merge.gravity->directions, 10U);
  EXPECT_FALSE(merge.gravity->levelled);
  ASSERT_TRUE(merge.fits[1].up_error);
  EXPECT_LT(*merge.fits[1].up_error, 0.5 * radians_per_degree);

  RunMergerConfig level;
  level.merge.level_map = true;
  const RunMerge levelled = merged({&first, &second}, level);
  ASSERT_TRUE(levelled.joined(1));
  EXPECT_TRUE(levelled.gravity->levelled);
  EXPECT_EQ(levelled.gravity->tilt, merge.gravity->tilt) << "before it was levelled";
  EXPECT_LT(degreesBetween(levelled.gravity->up_map, Eigen::Vector3d::UnitZ()), 1e-9);
  for (const std::vector<Pose>& poses : levelled.poses)
  {
    for (const Pose& pose : poses)
    {
      EXPECT_LT(degreesBetween(pose.linear().col(2), Eigen::Vector3d::UnitZ()), 1);
    }
  }
  EXPECT_LT(errorBetween(levelled, {&first, &second}, 0, 1), 0.08);

  RunMergerConfig without;
  without.merge.gravity = false;
  EXPECT_FALSE(merged({&first, &second}, without).gravity);
}

TEST(RunMergerReferences, AMergeIsLevelIfTheFirstRunIs)
{
  OverlappingRuns overlapping;
  auto& [level, tilted] = overlapping;
  tilt(level, 0, 0, 0);
  level.references.gravity->levelled = true;
  tilt(tilted, 0, 8, -3);
  georeference(level);
  const RunMerge of_level = merged({&level, &tilted});
  ASSERT_TRUE(of_level.joined(1));
  EXPECT_TRUE(of_level.gravity->levelled);
  EXPECT_LT(degreesBetween(of_level.poses[1][0].linear().col(2), Eigen::Vector3d::UnitZ()), 1);
  EXPECT_LT(errorOnEarth(of_level, level, 0), 1.5);

  const double tilt_angle = tilted.references.gravity->tilt;
  tilted.references.gravity.reset();  // the first run does not know its vertical
  const RunMerge of_tilted = merged({&tilted, &level});
  ASSERT_TRUE(of_tilted.joined(1));
  ASSERT_TRUE(of_tilted.gravity);
  EXPECT_FALSE(of_tilted.gravity->levelled) << "the first run's map frame";
  EXPECT_NEAR(of_tilted.gravity->tilt, tilt_angle, radians_per_degree);
  EXPECT_LT(errorOnEarth(of_tilted, level, 1), 1.5);
}

TEST(RunMergerReferences, EachRunHasABiasOfItsOwn)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  tilt(first, 0, 8, -3);
  tilt(second, 20, -6, 5);
  const Eigen::Vector3d up = first.references.gravity->up_map;
  fuseGravity(first, {0.15, -0.1, 0});  // 1 deg
  fuseGravity(second, {-0.1, 0.15, 0});
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.08);
  ASSERT_TRUE(merge.gravity);
  EXPECT_TRUE(merge.gravity->fused);
  EXPECT_LT(degreesBetween(merge.gravity->up_map, up), 0.5);
}
}  // namespace
}  // namespace dyslam
