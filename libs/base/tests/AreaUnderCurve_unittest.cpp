// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/AreaUnderCurve.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
TEST(AreaUnderCurve, CountsPairsInOrder)
{
  EXPECT_DOUBLE_EQ(areaUnderCurve({0.9F, 0.8F}, {0.1F}), 1);
  EXPECT_DOUBLE_EQ(areaUnderCurve({0.5F}, {0.5F}), 0.5);
  // Of the four pairs: 0.9 > 0.7, 0.9 > 0.2, 0.4 < 0.7, 0.4 > 0.2.
  EXPECT_DOUBLE_EQ(areaUnderCurve({0.9F, 0.4F}, {0.7F, 0.2F}), 0.75);
}

TEST(AreaUnderCurve, NotANumberWithoutEitherClass)
{
  EXPECT_TRUE(std::isnan(areaUnderCurve({}, {0.5F})));
  EXPECT_TRUE(std::isnan(areaUnderCurve({0.5F}, {})));
}
}  // namespace
}  // namespace dyslam
