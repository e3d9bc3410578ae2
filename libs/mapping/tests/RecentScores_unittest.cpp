// SPDX-License-Identifier: BSD-3-Clause
#include "../src/RecentScores.h"

#include <gtest/gtest.h>

using dyslam::RecentScores;

namespace
{
constexpr std::uint64_t here = 7;
constexpr std::uint64_t there = 8;

TEST(RecentScores, OneScanThatDisagreesIsOutvoted)
{
  RecentScores scores;
  for (std::size_t scan = 0; scan < 3; ++scan)
  {
    scores.beginScan(scan);
    EXPECT_FLOAT_EQ(scores.smooth(here, -4), -4);
  }
  scores.beginScan(3);
  EXPECT_FLOAT_EQ(scores.smooth(here, 2), -1);
  EXPECT_FLOAT_EQ(scores.smooth(there, 2), 2) << "a voxel that no scan before had";
  scores.beginScan(4);
  EXPECT_FLOAT_EQ(scores.smooth(here, 2), 0.5F) << "the smoothed score is remembered";
}

TEST(RecentScores, SureScoresAreKept)
{
  RecentScores scores;
  scores.beginScan(0);
  EXPECT_FLOAT_EQ(scores.smooth(here, -5), -5);
  EXPECT_FLOAT_EQ(scores.smooth(there, 5), 5);
  scores.beginScan(1);
  EXPECT_FLOAT_EQ(scores.smooth(here, 4), 4) << "something arrived there";
  EXPECT_FLOAT_EQ(scores.smooth(there, -4), -4) << "it has left";
}

TEST(RecentScores, AreRememberedForTwoScans)
{
  for (const std::size_t gap : {1U, 2U, 3U})
  {
    RecentScores scores;
    scores.beginScan(10);
    EXPECT_FLOAT_EQ(scores.smooth(here, -4), -4);
    if (gap == 2)
    {
      scores.beginScan(11);  // a scan without the voxel
    }
    scores.beginScan(10 + gap);
    EXPECT_FLOAT_EQ(scores.smooth(here, 2), gap < 3 ? -1 : 2) << gap;
  }
}
}  // namespace
