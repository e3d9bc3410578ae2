// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/sim/ClipGenerator.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <set>

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
