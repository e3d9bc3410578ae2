// SPDX-License-Identifier: BSD-3-Clause
#include "YamlText.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
TEST(YamlText, PlainWhereAPlainScalarHasThatMeaning)
{
  for (const char* name : {"grid.png", "my map.png", "a:b.png", "a#b.png", "-1.png", "?.png",
                           "it's.png", "3.png", "m\xC3\xBCnster.png", "a[1].png", "C:\\m.png"})
  {
    EXPECT_EQ(name, yamlText(name));
    EXPECT_EQ(name, fromYamlText(name));
  }
}

TEST(YamlText, QuotedOtherwise)
{
  EXPECT_EQ("\"#1.png\"", yamlText("#1.png"));
  EXPECT_EQ("\"a: b.png\"", yamlText("a: b.png"));
  EXPECT_EQ("\"a #1.png\"", yamlText("a #1.png"));
  EXPECT_EQ("\"[x].png\"", yamlText("[x].png"));
  EXPECT_EQ("\"- a.png\"", yamlText("- a.png"));
  EXPECT_EQ("\"\\\"q\\\".png\"", yamlText("\"q\".png"));
  EXPECT_EQ("\"a\\x0Ab.png\"", yamlText("a\nb.png"));
  for (const std::string name :
       {"#1.png", "a: b.png", "- a.png", "\"q\" \\ '.png", "a\nb\t.png", " a.png", "'a'.png",
        "%.png", "@x.png", "`.png", "!.png", "*&.png", "{}.png", "a:", ""})
  {
    const std::string text = yamlText(name);
    EXPECT_EQ('"', text.front()) << name;
    EXPECT_EQ(name, fromYamlText(text));
    EXPECT_EQ(name, fromYamlText(text + ": [1, 2]", ": [")) << "as a key";
  }
  EXPECT_EQ("a.las", fromYamlText("a.las: [1, 2]", ": ["));
}
}  // namespace
}  // namespace dyslam
