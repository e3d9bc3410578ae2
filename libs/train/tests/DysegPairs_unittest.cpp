// SPDX-License-Identifier: BSD-3-Clause
#include "DysegPairs.h"

#include <gtest/gtest.h>

#include <set>

namespace
{
dyslam::DysegTrainerOptions simulatedOnly()
{
  dyslam::DysegTrainerOptions options;
  options.simulated_share = 1;
  options.few_beams_share = 1;
  options.campus_share = 0;
  options.highway_share = 0;
  options.same_scan_share = 0;
  return options;
}

/** Tenths of a second between the scans of some pairs. */
std::multiset<int> gapsOf(const dyslam::DysegPairs& pairs)
{
  std::multiset<int> gaps;
  for (std::uint64_t i = 0; i < 20; ++i)
  {
    dyslam::RandomDraws draws(1, i);
    gaps.insert(static_cast<int>(pairs.draw(draws).elapsed * 10 + 0.5));
  }
  return gaps;
}

TEST(DysegPairs, AShareIsAsFarApartAsInTheApplication)
{
  auto options = simulatedOnly();
  options.gap_share = 1;
  dyslam::DysegPairs all(options);
  all.prepare(0);
  EXPECT_EQ(gapsOf(all).count(8), 20U);

  options.gap_share = 0;
  dyslam::DysegPairs any(options);
  any.prepare(0);
  const auto gaps = gapsOf(any);
  EXPECT_LT(gaps.count(8), 10U);
  EXPECT_GE(*gaps.begin(), 1);
  EXPECT_LE(*gaps.rbegin(), 10);
}

TEST(DysegPairs, ClipsOfAStepDoNotDependOnTheStepsBefore)
{
  auto options = simulatedOnly();
  options.simulated_pool = 2;
  options.simulate_every = 1;
  dyslam::DysegPairs going(options);
  for (int step = 0; step <= 3; ++step)
  {
    going.prepare(step);
  }
  dyslam::DysegPairs resumed(options);
  resumed.prepare(3);
  for (std::uint64_t i = 0; i < 5; ++i)
  {
    dyslam::RandomDraws a(1, i);
    dyslam::RandomDraws b(1, i);
    EXPECT_TRUE(going.draw(a).current == resumed.draw(b).current);
  }
}
}  // namespace
