// SPDX-License-Identifier: BSD-3-Clause
// Cells of the local map, and the spacing of a lidar's rings.
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "RegistrationTest.h"

namespace dyslam
{
namespace
{
using test::step;

class CellsAndRings : public test::RegistrationTest
{
};

/** Every n-th of the scene's 32 rings. */
Frame everyRing(int n, Frame frame)
{
  Cloud cloud;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (frame.scan.ring[frame.cloud.source[i]] % n == 0)
    {
      cloud.points.push_back(frame.cloud.points[i]);
      cloud.source.push_back(frame.cloud.source[i]);
    }
  }
  frame.cloud = cloud;
  return frame;
}

/** With cells of one size, sparse rings give fewer surfaces, which does not lower the inlier ratio
 * of those that exist. Rings too far apart give only surfaces of single rings, and no motion;
 * additional larger cells solve it. */
TEST_P(CellsAndRings, TheGateSeparatesFewSurfacesFromABadFit)
{
  const Pose T = poseFromYpr(0.1, 0.02, 0, 0.005, 0, 0);
  const auto registerEvery = [&](int n, int levels)
  {
    RefineOptions o = options();
    o.levels = levels;
    LocalMapRegistration registration(o, pool_);
    step(registration, everyRing(n, scene_.frame(Pose::Identity(), 0.01, 1)), Pose::Identity());
    return step(registration, everyRing(n, scene_.frame(T, 0.01, 2)), T, 0.1);
  };
  const RegistrationResult every_ring = registerEvery(1, 1);
  const RegistrationResult every_second = registerEvery(2, 1);
  EXPECT_TRUE(every_second.motion.converged()) << every_second.motion.reason;
  EXPECT_LT(every_second.surface_share, 0.8 * every_ring.surface_share);
  EXPECT_NEAR(every_second.inlier_ratio, every_ring.inlier_ratio, 0.15);
  const RegistrationResult every_fifth = registerEvery(5, 1);
  EXPECT_FALSE(every_fifth.motion.converged());
  EXPECT_NE(every_fifth.motion.reason.find("refine.cell_size"), std::string::npos)
      << every_fifth.motion.reason;
  const RegistrationResult in_levels = registerEvery(5, 4);
  EXPECT_TRUE(in_levels.motion.converged()) << in_levels.motion.reason;
  EXPECT_LT((T.inverse() * in_levels.T_odom_vehicle).translation().norm(), 0.03);
}

/** The scene, with a third of the rings. */
Frame seenBySparseRings(const test::StreetScene& scene, const Pose& T, unsigned seed)
{
  constexpr int n = 3;
  Frame frame = everyRing(n, scene.frame(T, 0.01, seed));
  for (std::size_t i = 0; i < frame.scan.size(); ++i)
  {
    const int ring = frame.scan.ring[i];
    frame.scan.ring[i] = static_cast<std::uint16_t>(ring / n);
    if (ring % n != 0)
    {
      frame.scan.points[i].setZero();
    }
  }
  return frame;
}

/** With sparse rings the spacing of the rings determines the cells, of the scan's own surfaces too,
 * not the option. */
TEST_P(CellsAndRings, CellsAreAsLargeAsSparseRingsRequire)
{
  const Pose T = poseFromYpr(0.1, 0.02, 0, 0.005, 0, 0);
  const auto poseWith = [&](double cell_size)
  {
    RefineOptions o = options();
    o.cell_size = cell_size;
    LocalMapRegistration registration(o, pool_);
    step(registration, seenBySparseRings(scene_, Pose::Identity(), 1), Pose::Identity());
    return step(registration, seenBySparseRings(scene_, T, 2), Pose::Identity(), 0.1)
        .T_odom_vehicle;
  };
  const Pose found = poseWith(0.3);
  EXPECT_LT((T.inverse() * found).translation().norm(), 0.08) << "registered";
  EXPECT_EQ(found.matrix(), poseWith(0.6).matrix());
}

/** The rings of a further lidar, which have other numbers, change nothing. */
TEST_P(CellsAndRings, CellsAreByTheRingsOfTheFirstLidar)
{
  const Pose T = poseFromYpr(0.1, 0.02, 0, 0.005, 0, 0);
  const auto poseWith = [&](bool further)
  {
    const auto frameAt = [&](const Pose& at, unsigned seed)
    {
      Frame frame = seenBySparseRings(scene_, at, seed);
      if (further)  // none of its points is in the cloud
      {
        Scan rear = frame.scan;
        rear.T_vehicle_lidar = poseFromYpr(-1, 0, 1, M_PI, -0.1, 0);
        appendScan(rear, 1, frame.scan);
      }
      return frame;
    };
    LocalMapRegistration registration(options(), pool_);
    step(registration, frameAt(Pose::Identity(), 1), Pose::Identity());
    return step(registration, frameAt(T, 2), Pose::Identity(), 0.1).T_odom_vehicle;
  };
  EXPECT_EQ(poseWith(true).matrix(), poseWith(false).matrix());
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         CellsAndRings,
                         testing::Values(RefineMethod::point_to_plane, RefineMethod::gicp),
                         test::methodName);
}  // namespace
}  // namespace dyslam
