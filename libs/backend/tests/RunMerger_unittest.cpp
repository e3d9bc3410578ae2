// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/RunMerger.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "BoxWorld.h"
#include "MergedRuns.h"
#include "TestFolder.h"

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
using test::turnedRound;

TEST(RunMerger, TwoHalvesOfOneDriveMeetWhereTheyOverlap)
{
  const OverlappingRuns overlapping;
  const auto& [first, second] = overlapping;
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_TRUE(merge.poses[0][0].isApprox(Pose::Identity(), 1e-9)) << "the first run's map frame";
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.06);
  ASSERT_GT(merge.loops.size(), 5U);
  for (const RunLoop& loop : merge.loops)
  {
    EXPECT_EQ(loop.run_from, 0U);
    EXPECT_EQ(loop.run_to, 1U);
    EXPECT_LT(loop.loop.to, 25U) << "keyframes of the second run that lie in the overlap";
    EXPECT_GE(loop.loop.from, 35U);
  }
}

TEST(RunMerger, TheOtherDirectionFromAnotherStart)
{
  const BoxWorld world(12, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 120, 1.5);
  const TestRun first(world, part(drive, 0, 60), 3);
  const TestRun second(world, turnedRound(part(drive, 20, 75)), 4);
  const RunMerge merge = merged({&first, &second});
  ASSERT_TRUE(merge.joined(1));
  EXPECT_LT(errorBetween(merge, {&first, &second}, 0, 1), 0.08);
}

TEST(RunMerger, OneRunIsThePrefixOfAnother)
{
  const BoxWorld world(13, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 90, 1.5);
  const TestRun whole(world, drive, 5);
  const TestRun prefix(world, part(drive, 0, 25), 6);
  for (const auto& runs : {std::vector<const TestRun*>{&whole, &prefix}, {&prefix, &whole}})
  {
    const RunMerge merge = merged(runs);
    ASSERT_TRUE(merge.joined(1));
    EXPECT_LT(errorBetween(merge, runs, 0, 1), 0.06);
  }
}

TEST(RunMerger, AChainIsJoinedWhateverTheOrder)
{
  const BoxWorld world(14, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 156, 1.5);
  const TestRun a(world, part(drive, 0, 40), 7);
  const TestRun b(world, part(drive, 25, 80), 8);
  const TestRun c(world, part(drive, 65, 104), 9);  // shares no place with a
  const RunMerge merge = merged({&a, &c, &b});
  ASSERT_TRUE(merge.joined(1));
  ASSERT_TRUE(merge.joined(2));
  EXPECT_LT(errorBetween(merge, {&a, &c, &b}, 0, 2), 0.08);
  EXPECT_LT(errorBetween(merge, {&a, &c, &b}, 1, 2), 0.08);
  const auto between_a_and_c = [](const RunLoop& loop)
  { return loop.run_from == 0 && loop.run_to == 1; };
  EXPECT_EQ(std::count_if(merge.loops.begin(), merge.loops.end(), between_a_and_c), 0);
}

TEST(RunMerger, RunsWithoutACommonPlaceAreNotJoined)
{
  const std::vector<Pose> drive = driveAround(30, 20, 75, 1.5);
  const TestRun here(BoxWorld(15, 30, 20), drive, 10);
  const TestRun elsewhere(BoxWorld(16, 30, 20), drive, 11);
  const RunMerge merge = merged({&here, &elsewhere});
  EXPECT_TRUE(merge.joined(0));
  EXPECT_FALSE(merge.joined(1));
  EXPECT_TRUE(merge.loops.empty());
  ASSERT_EQ(merge.evidence.size(), 2U);
  EXPECT_EQ(merge.evidence[1].needed, 4U);
  EXPECT_FALSE(merge.evidence[1].placed);
  EXPECT_LT(merge.evidence[1].loops, 4U);
}

TEST(RunMerger, APlaceThatExistsFourTimesIsNoEvidence)
{
  const BoxWorld world = BoxWorld::square(21, 30);
  const std::vector<Pose> drive = driveAround(30, 30, 225, 1.5);
  const TestRun round(world, drive, 12);
  const TestRun side(world, part(drive, 5, 28), 13);
  EXPECT_FALSE(merged({&round, &side}).joined(1));
}

TEST(RunMerger, AStreetThatLooksLikeAnotherForAWhileIsFoundOut)
{
  const std::vector<Pose> drive = driveAround(30, 20, 75, 1.5);
  const TestRun here(BoxWorld(17, 30, 20), drive, 14);
  TestRun alike(BoxWorld(18, 30, 20), drive, 15);
  for (std::size_t k = 0; k < 14; ++k)
  {
    alike.scans[k] = here.scans[k];
  }
  const RunMerge refused = merged({&here, &alike});
  EXPECT_FALSE(refused.joined(1));
  ASSERT_EQ(refused.evidence.size(), 2U);
  const JoinEvidence& evidence = refused.evidence[1];
  EXPECT_TRUE(evidence.placed);
  EXPECT_GE(evidence.loops, evidence.needed);
  EXPECT_LT(2 * evidence.confirmed, evidence.tried);
  RunMergerConfig unconfirmed;
  unconfirmed.merge.min_confirmed = 0;
  EXPECT_TRUE(merged({&here, &alike}, unconfirmed).joined(1)) << "what the check is there for";
}

TEST(RunMerger, TheMemoryLimitDoesNotChangeTheResult)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 120, 1.5);
  const TestRun first(world, part(drive, 0, 50), 1);
  const TestRun second(world, part(drive, 30, 80), 2);
  const RunMerge expected = merged({&first, &second});
  RunMergerConfig limited;
  limited.memory = MemoryLimit(MemoryOptions{}, ::testing::TempDir());
  limited.memory.bytes = 100000;
  const RunMerge merge = merged({&first, &second}, limited);
  EXPECT_GT(limited.memory.file->size(), 500000U) << "most of it was on disk";
  ASSERT_TRUE(merge.joined(1));
  ASSERT_EQ(merge.loops.size(), expected.loops.size());
  for (std::size_t run = 0; run < 2; ++run)
  {
    ASSERT_EQ(merge.poses[run].size(), expected.poses[run].size());
    for (std::size_t k = 0; k < merge.poses[run].size(); ++k)
    {
      EXPECT_EQ(merge.poses[run][k].matrix(), expected.poses[run][k].matrix()) << run << " " << k;
    }
  }
}

TEST(RunMerger, LoopsThatARunLeftOutAreNotUsed)
{
  const BoxWorld world(11, 30, 20);
  const std::vector<Pose> drive = driveAround(30, 20, 120, 1.5);
  TestRun first(world, part(drive, 0, 50), 1);
  const TestRun second(world, part(drive, 30, 80), 2);
  const RunMerge expected = merged({&first, &second});
  first.graph.leaveOut(first.graph.add(std::make_unique<LoopFactor>(
      3, 45, poseFromYpr(1, 2, 0, 0, 0, 0), Matrix6(1e4 * Matrix6::Identity()))));
  const RunMerge merge = merged({&first, &second});
  ASSERT_EQ(merge.poses[1].size(), expected.poses[1].size());
  EXPECT_EQ(merge.poses[1].back().matrix(), expected.poses[1].back().matrix());
}

TEST(RunMerger, LimitsOfAppearanceCountWithoutThatOfSingleRuns)
{
  RunMergerConfig config;
  config.loops.appearance = false;
  EXPECT_NO_THROW(RunMerger{config});
  config.loops.interval = 6;  // enough for nearby loops
  const std::string message = messageOfError<UserError>([&] { const RunMerger merger(config); });
  EXPECT_TRUE(contains(message, "[loop] appearance_min_support = 3 cannot be reached")) << message;
}

TEST(RunMerger, FalseUseIsRefused)
{
  const BoxWorld world(19, 30, 20);
  const TestRun run(world, driveAround(30, 20, 6, 1.5), 16);
  RunMerger merger{RunMergerConfig{}};
  EXPECT_THROW(merger.addRun(FactorGraph()), std::invalid_argument);
  EXPECT_THROW(merger.addKeyframe({}), std::invalid_argument);
  merger.addRun(run.graph);
  EXPECT_THROW(merger.addRun(run.graph), std::invalid_argument) << "its points are missing";
  for (std::size_t k = 0; k < run.truth.size(); ++k)
  {
    merger.addKeyframe({});
  }
  EXPECT_THROW(merger.addKeyframe({}), std::invalid_argument);
  merger.addRun(run.graph);
  for (std::size_t k = 0; k < run.truth.size(); ++k)
  {
    merger.addKeyframe({});
  }
  EXPECT_FALSE(merger.merge().joined(1)) << "keyframes without points show nothing";
}
}  // namespace
}  // namespace dyslam
