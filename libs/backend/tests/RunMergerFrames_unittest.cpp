// SPDX-License-Identifier: BSD-3-Clause
// Runs that were localised in a prior map, merged.
#include <dyslam/backend/RunMerger.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
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

/** The run is localised in a prior map at every second keyframe, and in its frame. Its odometry
 * takes every step for one per cent too long.
 * \param map_frame name of the frame of the prior map */
void localiseIn(TestRun& run, const Pose& T_map_world, const std::string& map_frame)
{
  const auto informationOf = [](double sigma, double sigma_rotation)
  {
    Vector6 sigmas;
    sigmas << Eigen::Vector3d::Constant(sigma), Eigen::Vector3d::Constant(sigma_rotation);
    return Matrix6(sigmas.cwiseAbs2().cwiseInverse().asDiagonal());
  };
  FactorGraph graph;
  graph.addPose(Key::priorMap(), Pose::Identity());
  graph.setFixed(Key::priorMap(), true);
  for (std::size_t k = 0; k < run.truth.size(); ++k)
  {
    const Pose pose = T_map_world * run.truth[k];
    graph.addPose(Key::ego(k), pose);
    if (k > 0)
    {
      Pose step = run.truth[k - 1].inverse() * run.truth[k];
      step.translation() *= 1.01;
      graph.add(std::make_unique<OdometryFactor>(k - 1, k, step, informationOf(0.01, 0.0005)));
    }
    if (k % 2 == 0)
    {
      graph.add(std::make_unique<LocalisationFactor>(k, pose, informationOf(0.03, 0.002)));
    }
  }
  run.graph = std::move(graph);
  run.references.map_frame = map_frame;
}

/** Largest error of the merged poses of a run, if the merged map is in the frame of `T_map_world`
 * [m]. */
double largestErrorOf(const std::vector<Pose>& merged_poses,
                      const TestRun& run,
                      const Pose& T_map_world)
{
  double worst = merged_poses.empty() ? 1e9 : 0;
  for (std::size_t k = 0; k < merged_poses.size(); ++k)
  {
    const Pose T_true = T_map_world * run.truth[k];
    worst = std::max(worst, (merged_poses[k].translation() - T_true.translation()).norm());
  }
  return worst;
}

TEST(RunMergerFrames, RunsInOnePriorMapNeedNoCommonPlace)
{
  const Pose T_map_world = poseFromYpr(100, -40, 3, 1, 0, 0);
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 150, 1.5);
  TestRun first(world, part(drive, 0, 35), 1);
  TestRun second(world, part(drive, 55, 90), 2);
  localiseIn(first, T_map_world, "map");
  localiseIn(second, T_map_world, "map");
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_LT(largestErrorOf(merge.poses[0], first, T_map_world), 0.15);
  EXPECT_LT(largestErrorOf(merge.poses[1], second, T_map_world), 0.15);
  EXPECT_TRUE(merge.loops.empty());
  EXPECT_EQ(merge.evidence[1].tried, 0U);
  EXPECT_TRUE(merge.optimisation.warnings.empty());

  second.references.map_frame = "another map";
  const RunMerge apart = merged({&first, &second});
  EXPECT_FALSE(apart.joined(1));
  EXPECT_LT(largestErrorOf(apart.poses[0], first, T_map_world), 0.15);
}

TEST(RunMergerFrames, LocalisationsHoldRunsThatLoopsJoin)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  const Pose T_map_world = poseFromYpr(100, -40, 3, 1, 0, 0);
  localiseIn(second, T_map_world, "a map that the first run does not know");
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_GT(merge.loops.size(), 5U);
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.15);
  // 60 m of it are beyond the first run: by the odometry alone these are 0.6 m too long.
  const auto lengthOf = [](const std::vector<Pose>& poses)
  { return (poses.back().translation() - poses.front().translation()).norm(); };
  EXPECT_NEAR(lengthOf(merge.poses[1]), lengthOf(second.truth), 0.25);
}

TEST(RunMergerFrames, ARunInTheMapOfAnother)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  first.references.map_frame = "first";
  localiseIn(second, first.truth.front().inverse(), "first");
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_TRUE(merge.poses[0][0].isApprox(Pose::Identity(), 1e-9));
  EXPECT_GT(merge.loops.size(), 5U);
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.15);
}

/** A map that was made again in another frame since the second run was localised in it. */
TEST(RunMergerFrames, AWrongFrameIsRefusedAndLoopsJoin)
{
  OverlappingRuns overlapping;
  auto& [first, second] = overlapping;
  first.references.map_frame = second.references.map_frame = "map";
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_GT(merge.loops.size(), 5U);
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.06);
}
}  // namespace
}  // namespace dyslam
