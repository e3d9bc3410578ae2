// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/GroundSquare.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace dyslam
{
namespace
{
constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(GroundSquare, KnowsTheLowestReturnsInAnyOrder)
{
  std::vector<float> heights{-2, -1, 0, 0, 5};
  do
  {
    GroundSquare square;
    for (const float z : heights)
    {
      square.add(z);
    }
    EXPECT_EQ(square.count(), heights.size());
    EXPECT_EQ(square.lowest(), -2);
    EXPECT_EQ(square.thirdLowest(), 0);
  } while (std::next_permutation(heights.begin(), heights.end()));
}

TEST(GroundSquare, OfFewerThanThreeReturnsTakesTheHighest)
{
  GroundSquare square;
  EXPECT_EQ(square.thirdLowest(), infinity);
  square.add(1);
  EXPECT_EQ(square.thirdLowest(), 1);
  square.add(-1);
  EXPECT_EQ(square.thirdLowest(), 1);
  EXPECT_EQ(square.lowest(), -1);
}

TEST(GroundSquare, ReturnsThatAreNotFiniteAreNoGround)
{
  GroundSquare square;
  square.add(std::numeric_limits<float>::quiet_NaN());
  square.add(infinity);
  EXPECT_EQ(square.lowest(), infinity);
  EXPECT_EQ(square.thirdLowest(), infinity);
  square.add(3);
  EXPECT_EQ(square.thirdLowest(), 3);
}

TEST(GroundAround, LimitsTheGroundByTheMedian)
{
  GroundAround around;
  EXPECT_EQ(around.highest(), infinity) << "nothing is known";
  around.add(2);
  EXPECT_FLOAT_EQ(around.highest(), 2.3F);
  around.add(0);
  EXPECT_FLOAT_EQ(around.highest(), 2.3F) << "the upper median of two";
  for (int i = 0; i < 7; ++i)
  {
    around.add(0);
  }
  EXPECT_FLOAT_EQ(around.highest(), 0.3F) << "a roof among nine squares";
}
}  // namespace
}  // namespace dyslam
