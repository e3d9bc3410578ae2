// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Words.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace dyslam
{
namespace
{
using Words = std::vector<std::string>;

TEST(Words, AreJoinedWithASeparatorBetweenThem)
{
  EXPECT_EQ("", joined(Words{}));
  EXPECT_EQ("a", joined(Words{"a"}));
  EXPECT_EQ("a, b, c", joined(Words{"a", "b", "c"}));
  EXPECT_EQ("a b", joined(Words{"a", "b"}, " "));
  std::string list;
  appendWord(list, "a");
  appendWord(list, "b");
  EXPECT_EQ("a, b", list);
}

TEST(Words, UnknownOnesNameTheNearestAndTheKnown)
{
  EXPECT_EQ("unknown kernel 'cauchi'; did you mean 'cauchy'? (one of: none, cauchy)",
            unknownWord("kernel", "cauchi", Words{"none", "cauchy"}));
  EXPECT_EQ("unknown kernel 'x' (one of: none, cauchy)",
            unknownWord("kernel", "x", Words{"none", "cauchy"}));
  EXPECT_EQ("unknown ending '' (one of: .a)", unknownWord("ending", "", Words{".a"}));
  Words many;
  for (int i = 0; i < 21; ++i)
  {
    many.push_back("section_" + std::to_string(i));
  }
  EXPECT_EQ("unknown section 'x'", unknownWord("section", "x", many));
  EXPECT_EQ("unknown section 'section_'; did you mean 'section_0'?",
            unknownWord("section", "section_", many));
}

TEST(Words, TrimmedTextHasNoBlanksAtItsEnds)
{
  EXPECT_EQ("a b", trimmed(" \ta b\r"));
  EXPECT_EQ("a b", trimmed("a b"));
  EXPECT_EQ("", trimmed(""));
  EXPECT_EQ("", trimmed(" \t \r"));
  EXPECT_EQ("a\r", trimmed("\"a\r\" ", " \"")) << "only the given characters";
}
}  // namespace
}  // namespace dyslam
