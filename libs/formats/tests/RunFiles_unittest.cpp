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
  EXPECT_TRUE(isFileOfRun(folder.file("map.png")));
  EXPECT_FALSE(isFileOfRun(folder.file("mine.png")));
  for (const char* other : {"{", "[]", R"({"files": 3})"})
  {
    folder.write("report.json", other);
    EXPECT_TRUE(filesOfRun(folder.path()).empty()) << other;
  }
}

TEST(RunFiles, AConvertedRecordingIsMovedWithItsRun)
{
  const TestFolder folder;
  const std::string before = folder.file("before/recording.rawlog");
  EXPECT_EQ(recordingOfRun(folder.file("run"), before), before) << "neither is there";
  const std::string beside = folder.write("run/recording.rawlog", "");
  EXPECT_EQ(recordingOfRun(folder.file("run"), before), beside);
  EXPECT_EQ(recordingOfRun(folder.file("run"), ""), "");
  folder.write("before/recording.rawlog", "");
  EXPECT_EQ(recordingOfRun(folder.file("run"), before), before);
}

TEST(RunFiles, TheMapIsOfEitherFormat)
{
  const TestFolder folder;
  EXPECT_EQ(staticMapOfRun(folder.path()), "");
  const std::string ply = folder.write("map_static.ply", "");
  EXPECT_EQ(staticMapOfRun(folder.path()), ply);
  const std::string pcd = folder.write("map_static.pcd", "");
  EXPECT_EQ(staticMapOfRun(folder.path()), pcd);
}

TEST(RunFiles, AFolderOfARunHasSettingsAndReport)
{
  const TestFolder folder;
  EXPECT_FALSE(isRunFolder(folder.file("none")));
  folder.write("effective.ini", "");
  EXPECT_FALSE(isRunFolder(folder.path())) << "the run has not ended";
  folder.write("report.json", "");
  EXPECT_TRUE(isRunFolder(folder.path()));
}
}  // namespace dyslam
