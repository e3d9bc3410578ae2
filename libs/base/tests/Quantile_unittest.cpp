// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace dyslam
{
namespace
{
TEST(Quantile, IsTheElementOfTheSortedValues)
{
  std::mt19937 rng(1);
  for (std::size_t count = 1; count <= 40; ++count)
  {
    std::vector<float> values(count);
    std::generate(values.begin(), values.end(), [&] { return static_cast<float>(rng() % 20); });
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double share : {0.0, 0.02, 0.5, 0.8, 0.98, 1.0})
    {
      const auto place = static_cast<std::size_t>(share * static_cast<double>(count - 1));
      EXPECT_EQ(quantile(values, share), sorted[place]) << count << " " << share;
    }
    for (const std::size_t parts : {2U, 4U, 10U})
    {
      EXPECT_EQ(lowQuantile(values, parts), sorted[count / parts]) << count << " " << parts;
    }
    EXPECT_EQ(upperMedian(values), sorted[count / 2]) << count;
  }
}

TEST(Quantile, OfAnEvenNumberThereAreTwoMedians)
{
  std::vector<int> values{7, 1, 5, 3};
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(upperMedian(values), 5);
  EXPECT_EQ(lowQuantile(values, 4), 3);
}

TEST(Quantile, OfPartOfAnArray)
{
  std::array<double, 5> values{4, 2, 9, -1, -2};
  EXPECT_EQ(upperMedian(values.begin(), values.begin() + 3), 4);
  EXPECT_EQ(lowQuantile(values.begin(), values.begin() + 3, 4), 2);
  EXPECT_EQ(values[3], -1);
  EXPECT_EQ(values[4], -2);
}
}  // namespace
}  // namespace dyslam
