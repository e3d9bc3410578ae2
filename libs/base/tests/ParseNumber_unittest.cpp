// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/ParseNumber.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
TEST(ParseNumber, ReadsWholeWordsOnly)
{
  EXPECT_EQ(parseNumber<double>("-2.5e1"), -25.0);
  EXPECT_EQ(parseNumber<double>("+3"), 3.0);
  EXPECT_EQ(parseNumber<float>("0.1"), 0.1F);
  for (const char* word : {"", "+", "1,5", "1.5x", " 1", "1 ", "0x10", "one"})
  {
    EXPECT_FALSE(parseNumber<double>(word).has_value()) << "'" << word << "'";
  }
}

TEST(ParseNumber, NumbersOutOfTheRangeOfTheTypeAreZeroOrInfinite)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(parseNumber<double>("1e999"), infinity);
  EXPECT_EQ(parseNumber<double>("-1e999"), -infinity);
  EXPECT_EQ(parseNumber<double>("1e-999"), 0.0);
  EXPECT_EQ(parseNumber<float>("1e60"), std::numeric_limits<float>::infinity());
  EXPECT_EQ(parseNumber<double>("inf"), infinity);
  EXPECT_TRUE(std::isnan(parseNumber<double>("nan").value_or(0)));
}
}  // namespace
}  // namespace dyslam
