// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RunFiles.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
TEST(RunFiles, AreThoseOfTheReport)
{
  const TestFolder folder;
  EXPECT_TRUE(filesOfRun(folder.path()).empty());
  folder.write("report.json", R"({"frames": 3, "files": ["map.png", "labels"]})");
  EXPECT_EQ(filesOfRun(folder.path()), (std::vector<std::string>{"map.png", "labels"}));
  for (const char* other : {"{", "[]", R"({"files": 3})"})
  {
    folder.write("report.json", other);
    EXPECT_TRUE(filesOfRun(folder.path()).empty()) << other;
  }
}
}  // namespace dyslam
