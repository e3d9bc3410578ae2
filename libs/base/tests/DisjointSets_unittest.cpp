// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/DisjointSets.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
TEST(DisjointSets, AreNamedByTheirSmallestMember)
{
  DisjointSets sets(6);
  sets.join(5, 3);
  sets.join(4, 2);
  EXPECT_EQ(sets.find(5), 3U);
  EXPECT_EQ(sets.find(4), 2U);
  sets.join(5, 4);
  sets.join(5, 4);
  for (const std::size_t i : {2U, 3U, 4U, 5U})
  {
    EXPECT_EQ(sets.find(i), 2U) << i;
  }
  EXPECT_EQ(sets.find(0), 0U);
  EXPECT_EQ(sets.find(1), 1U);
}
}  // namespace
}  // namespace dyslam
