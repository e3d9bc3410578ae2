// SPDX-License-Identifier: BSD-3-Clause
#include "../../apps/common/Shard.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace dyslam
{
TEST(Shard, PartsAreDisjointAndMakeTheWhole)
{
  const std::vector<int> all{1, 2, 3, 4, 5, 6, 7};
  std::multiset<int> seen;
  for (const char* text : {"1/3", "2/3", "3/3"})
  {
    const auto part = Shard::fromText(text).of(all);
    EXPECT_GE(part.size(), 2U);
    seen.insert(part.begin(), part.end());
  }
  EXPECT_EQ(seen, std::multiset<int>(all.begin(), all.end()));
  EXPECT_TRUE(Shard::fromText("9/9").of(all).empty());
}

TEST(Shard, RefusesWhatIsNoPart)
{
  for (const char* text : {"", "1", "0/3", "4/3", "a/b", "1/3x", "-1/3", "99999999999/3"})
  {
    EXPECT_THROW((void)Shard::fromText(text), UserError) << text;
  }
}
}  // namespace dyslam
