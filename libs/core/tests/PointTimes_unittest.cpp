// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PointTimes.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
TEST(PointTimes, TheExtentIsOfPossibleTimes)
{
  EXPECT_FALSE(timeExtent({}));
  EXPECT_FALSE(timeExtent({NAN, -INFINITY, 1e6F, -3e38F}));
  const auto extent = timeExtent({NAN, 0.05F, -1e6F, -0.03F, INFINITY, 3e38F});
  ASSERT_TRUE(extent);
  EXPECT_EQ(extent->first, -0.03F);
  EXPECT_EQ(extent->last, 0.05F);
  EXPECT_FLOAT_EQ(static_cast<float>(extent->duration()), 0.08F);
  EXPECT_EQ(timeExtent({-0.0F, NAN})->duration(), 0);
}
}  // namespace
}  // namespace dyslam
