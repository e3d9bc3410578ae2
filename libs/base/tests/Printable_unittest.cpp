// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <gtest/gtest.h>

namespace dyslam
{
TEST(Printable, ControlCharactersOfBothRangesAreReplaced)
{
  EXPECT_EQ("a?[31mb", printable("a\x1b[31mb"));
  EXPECT_EQ("a?31mb", printable("a\xC2\x9B"
                                "31mb"));
  EXPECT_EQ("a?b?", printable("a\nb\x7F"));
  EXPECT_EQ("K\xC3\xB6ln \xC2\xB0", printable("K\xC3\xB6ln \xC2\xB0"));
  EXPECT_EQ(503U, printable(std::string(1000, 'x')).size());
}

TEST(Printable, NumbersAreFormattedAtAnyLength)
{
  EXPECT_EQ("1.50 m of 7", formatted("%.2f m of %d", 1.5, 7));
  EXPECT_EQ("", formatted("%s", ""));
  EXPECT_EQ(std::string(2000, 'x') + "!", formatted("%s!", std::string(2000, 'x').c_str()));
}

TEST(Printable, WordsOfAShell)
{
  EXPECT_EQ("/data/drive_1.rawlog", shellWord("/data/drive_1.rawlog"));
  EXPECT_EQ("Fahrt-\xc3\xbc", shellWord("Fahrt-\xc3\xbc"));
  EXPECT_EQ("'out ware/x'", shellWord("out ware/x"));
  EXPECT_EQ("'it'\\''s'", shellWord("it's"));
  EXPECT_EQ("'$HOME'", shellWord("$HOME"));
  EXPECT_EQ("''", shellWord(""));
}

TEST(Printable, TextOfHtmlHasNoMarkup)
{
  EXPECT_EQ(escapedHtml("<a href=\"b\">&'c'"), "&lt;a href=&quot;b&quot;&gt;&amp;'c'");
}

TEST(Printable, DepthOfJsonCountsBracketsOutsideOfStrings)
{
  EXPECT_FALSE(isNestedDeeper("[[]]", 2));
  EXPECT_TRUE(isNestedDeeper("[[{}]]", 2));
  EXPECT_FALSE(isNestedDeeper(R"(["[[[", "\"[[["])", 1));
  EXPECT_FALSE(isNestedDeeper("[][][][]", 1));
  EXPECT_TRUE(isNestedDeeper(std::string(1000000, '[')));
}

TEST(Printable, FieldsOfCsvFilesAreQuotedWhereNeeded)
{
  EXPECT_EQ("too few inliers", csvField("too few inliers"));
  EXPECT_EQ("\"a, b\"", csvField("a, b"));
  EXPECT_EQ("\"PCL: \"\"x\"\"\"", csvField("PCL: \"x\""));
  EXPECT_EQ("\"a\rb\"", csvField("a\rb"));
}

}  // namespace dyslam
