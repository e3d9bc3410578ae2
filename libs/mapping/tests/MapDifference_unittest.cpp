// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/MapDifference.h>
#include <gtest/gtest.h>

#include "TestMap.h"

namespace dyslam
{
namespace
{
/** A scan with one point 10 m ahead of the origin and, if wanted, one to the left. */
Frame frameWith(std::size_t index, bool left, bool left_moves)
{
  Frame frame;
  frame.index = index;
  frame.cloud.points = {{10.05F, 0.05F, 1.05F}};
  frame.moving = {false};
  if (left)
  {
    frame.cloud.points.emplace_back(0.05F, 10.05F, 1.05F);
    frame.moving.push_back(left_moves);
  }
  frame.cloud.intensity.assign(frame.cloud.points.size(), 0.5F);
  frame.cloud.source.assign(frame.cloud.points.size(), 0);
  return frame;
}

TEST(RemovedPoints, AreThoseThatTheCleanedMapLacks)
{
  StaticMapOptions options;
  options.visibility = false;
  test::TestMap all(options);
  test::TestMap cleaned(options);
  all.insert(frameWith(0, true, false));
  cleaned.insert(frameWith(0, true, true));
  const auto removed = removedPoints(all.map.points(), cleaned.map);
  ASSERT_EQ(1U, removed.size());
  EXPECT_NEAR(10.05, removed[0].y(), 0.01);
  EXPECT_TRUE(removedPoints(all.map.points(), all.map).empty());
  EXPECT_EQ(2U, removedPoints(all.map.points(), test::TestMap(options).map).size());
}

TEST(RemovedPoints, AVoxelWithTooFewHitsIsNotInTheCleanedMap)
{
  StaticMapOptions options;
  options.visibility = false;
  test::TestMap all(options);
  options.min_hits = 2;
  test::TestMap cleaned(options);
  for (std::size_t k = 0; k < 2; ++k)
  {
    const Frame frame = frameWith(k, k == 0, false);  // left is seen once
    all.insert(frame);
    cleaned.insert(frame);
  }
  EXPECT_EQ(1U, removedPoints(all.map.points(), cleaned.map).size());
}
}  // namespace
}  // namespace dyslam
