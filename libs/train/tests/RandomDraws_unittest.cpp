// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/RandomDraws.h>
#include <gtest/gtest.h>

#include <set>

namespace dyslam
{
namespace
{
TEST(RandomDraws, TheSameSeedAndIndexGiveTheSameDraws)
{
  RandomDraws a(7, 3);
  RandomDraws b(7, 3);
  for (int i = 0; i < 100; ++i)
  {
    EXPECT_EQ(a.bits(), b.bits());
  }
}

TEST(RandomDraws, AreThoseOfEarlierTrainings)
{
  RandomDraws draws(7, 3);
  EXPECT_EQ(draws.bits(), 0x014CCAC5E052070CULL);
  EXPECT_EQ(draws.bits(), 0xE8BF0259B17AAD85ULL);
  EXPECT_EQ(draws.bits(), 0xD4E08DB901F10507ULL);
  EXPECT_DOUBLE_EQ(draws.uniform(), 0.83650922245536552);
  EXPECT_EQ(draws.below(1000), 9U);
  EXPECT_EQ(draws.byWeight({1, 2, 3}), 1U);
  EXPECT_NEAR(draws.normal(2), 0.65858658895143229, 1e-12);
}

TEST(RandomDraws, SeveralNormalDrawsAreFromTheLastToTheFirst)
{
  RandomDraws together(7, 3);
  RandomDraws one_by_one(7, 3);
  const auto [x, y, z] = together.normals<3>({1, 2, 3});
  EXPECT_EQ(z, one_by_one.normal(3));
  EXPECT_EQ(y, one_by_one.normal(2));
  EXPECT_EQ(x, one_by_one.normal(1));
}

TEST(RandomDraws, NeighbouringSeedsAndIndicesHaveNoDrawInCommon)
{
  constexpr std::uint64_t seeds = 20;
  constexpr std::uint64_t indices = 20;
  constexpr int draws = 50;
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
  {
    for (std::uint64_t index = 0; index < indices; ++index)
    {
      RandomDraws of_both(seed, index);
      for (int i = 0; i < draws; ++i)
      {
        seen.insert(of_both.bits());
      }
    }
  }
  EXPECT_EQ(seen.size(), seeds * indices * draws);
}

TEST(RandomDraws, FirstDrawsOfNeighbouringSeedsAreUniform)
{
  constexpr std::uint64_t count = 2000;
  double sum = 0;
  double products = 0;
  double before = 0.5;
  for (std::uint64_t seed = 0; seed < count; ++seed)
  {
    const double drawn = RandomDraws(seed, 0).uniform();
    sum += drawn;
    products += (drawn - 0.5) * (before - 0.5);
    before = drawn;
  }
  EXPECT_NEAR(sum / count, 0.5, 0.03);
  EXPECT_NEAR(products / count, 0, 0.008) << "as if independent";
}
}  // namespace
}  // namespace dyslam
