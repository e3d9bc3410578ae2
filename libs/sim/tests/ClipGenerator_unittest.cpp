// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/sim/ClipGenerator.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <utility>

#include "TestScans.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

TEST(ClipGenerator, ClipsDoNotDependOnTheirOrder)
{
  ClipOptions options;
  options.simulator.columns = 200;
  options.simulator.loop_length = 300;
  options.scans = 2;
  options.clips_per_world = 2;
  const ClipGenerator a(options), b(options);
  const auto a0 = a.clip(0), a1 = a.clip(1), a5 = a.clip(5);
  const auto b5 = b.clip(5), b1 = b.clip(1), b0 = b.clip(0);
  ASSERT_EQ(a0.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
  {
    EXPECT_TRUE(sameScan(a0[i], b0[i]));
    EXPECT_TRUE(sameScan(a1[i], b1[i]));
    EXPECT_TRUE(sameScan(a5[i], b5[i]));
  }
  EXPECT_FALSE(sameScan(a0[0], a1[0]));
  EXPECT_EQ(a.clipOptions(0).seed, a.clipOptions(1).seed);
}

TEST(ClipGenerator, AClipIsTheDriveOfItsOptions)
{
  ClipOptions options;
  options.simulator.columns = 100;
  options.simulator.loop_length = 200;
  options.scans = 1;
  const ClipGenerator generator(options);
  EXPECT_TRUE(sameScan(generator.clip(3).front(), Simulator(generator.clipOptions(3)).next()));
  EXPECT_NE(generator.clipOptions(3).traffic_seed, generator.clipOptions(4).traffic_seed);
}

TEST(ClipGenerator, OptionsThatAWorldOrAnEgoDoesNotHaveAreLeftOut)
{
  ClipOptions options;
  options.simulator.reverse = true;
  options.simulator.wheels = true;
  options.clips_per_world = 1;
  const ClipGenerator generator(options);
  std::set<std::pair<WorldKind, bool>> reversed;
  std::set<std::pair<EgoKind, bool>> with_wheels;
  for (std::uint64_t i = 0; i < 200; ++i)
  {
    const SimulatorOptions clip = generator.clipOptions(i);
    reversed.emplace(clip.world, clip.reverse);
    with_wheels.emplace(clip.ego, clip.wheels);
  }
  EXPECT_EQ(reversed, (std::set<std::pair<WorldKind, bool>>{{WorldKind::urban, true},
                                                            {WorldKind::campus, true},
                                                            {WorldKind::highway, false},
                                                            {WorldKind::tunnel, false},
                                                            {WorldKind::field, true}}));
  EXPECT_EQ(with_wheels,
            (std::set<std::pair<EgoKind, bool>>{
                {EgoKind::automatic, true}, {EgoKind::robot, true}, {EgoKind::handheld, false}}));
}

TEST(ClipGenerator, RefusesBoundsInTheWrongOrder)
{
  ClipOptions options;
  options.min_traffic = 0.6;
  options.max_traffic = 0.5;
  EXPECT_THROW(ClipGenerator{options}, UserError);
  options = {};
  options.least_seed = 10;
  options.most_seed = 9;
  EXPECT_THROW(ClipGenerator{options}, UserError);
}

TEST(ClipGenerator, WorldsHaveSeedsWithinTheirBounds)
{
  ClipOptions options;
  options.clips_per_world = 1;
  options.least_seed = 500000000;
  options.most_seed = 500000002;
  const ClipGenerator generator(options);
  std::set<int> seeds;
  for (std::uint64_t i = 0; i < 60; ++i)
  {
    seeds.insert(generator.clipOptions(i).seed);
  }
  EXPECT_EQ(seeds, (std::set<int>{500000000, 500000001, 500000002}));
}
}  // namespace
