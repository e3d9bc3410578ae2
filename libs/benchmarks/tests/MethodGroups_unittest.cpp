// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/benchmarks/MethodGroups.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace dyslam
{
namespace
{
using Words = std::vector<std::string>;
using Numbers = std::vector<std::size_t>;
}  // namespace

TEST(MethodGroups, WithoutARepeatedReferenceThereIsOne)
{
  EXPECT_TRUE(methodGroups({}, {}).empty());
  const auto groups = methodGroups({"a", "b"}, {"00.txt", "01.txt"});
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].name, "");
  EXPECT_EQ(groups[0].estimates, (Numbers{0, 1}));
}

TEST(MethodGroups, AreFromOneRepetitionToTheNext)
{
  const Words references{"p/00.txt", "p/01.txt", "p/./00.txt", "p/01.txt"};
  const auto groups = methodGroups({"out/ours/00/trajectory.txt", "out/ours/01/trajectory.txt",
                                    "out/gicp/00/trajectory.txt", "out/./gicp/01/trajectory.txt"},
                                   references);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].name, "ours");
  EXPECT_EQ(groups[0].estimates, (Numbers{0, 1}));
  EXPECT_EQ(groups[1].name, "gicp");
  EXPECT_EQ(groups[1].estimates, (Numbers{2, 3}));
  const auto behind =
      methodGroups({"00/ours.txt", "01/ours.txt", "00/gicp.txt", "01/gicp.txt"}, references);
  ASSERT_EQ(behind.size(), 2U);
  EXPECT_EQ(behind[1].name, "gicp");
  const auto deep = methodGroups(
      {"out/ours/00/kitti.txt", "out/ours/01/kitti.txt", "kiss/00.txt", "kiss/01.txt"}, references);
  ASSERT_EQ(deep.size(), 2U);
  EXPECT_EQ(deep[0].name, "out/ours/kitti");
  EXPECT_EQ(deep[1].name, "kiss");
}

TEST(MethodGroups, ThereAreNoneIfTheMethodsCannotBeTold)
{
  const Words interleaved{"00", "00", "01", "01"};
  EXPECT_TRUE(methodGroups({"a/00", "b/00", "a/01", "b/01"}, interleaved).empty());
  const Words twice{"00", "01", "00", "01"};
  EXPECT_TRUE(methodGroups({"a/00", "b/01", "b/00", "a/01"}, twice).empty()) << "mixed";
  EXPECT_TRUE(methodGroups({"a00", "a01", "b00", "b01"}, twice).empty()) << "no folders";
  EXPECT_TRUE(methodGroups({"a/00", "a/01", "b/00"}, {"00", "01", "00"}).empty())
      << "b lacks a reference";
  EXPECT_TRUE(methodGroups({"a/00", "b/00", "b/01"}, {"00", "00", "01"}).empty())
      << "a lacks a reference";
}
}  // namespace dyslam
