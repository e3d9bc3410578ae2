// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Statistics.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stdexcept>

namespace dyslam
{
namespace
{
TEST(Statistics, KnownValues)
{
  const auto s = statisticsOf({4, 1, 3, 2});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.max, 4);
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.standard_deviation, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(statisticsOf({5, 1, 2}).median, 2);
  EXPECT_EQ(statisticsOf({}).count, 0U);
  EXPECT_THROW((void)statisticsOf({1, std::nan("")}), std::invalid_argument);
}

TEST(Statistics, RatioOfNothingIsNone)
{
  EXPECT_EQ(std::nullopt, ratio(0, 0));
  EXPECT_DOUBLE_EQ(0.75, ratio(3, 4).value());
}
}  // namespace
}  // namespace dyslam
