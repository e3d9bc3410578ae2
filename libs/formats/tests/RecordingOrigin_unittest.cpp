// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RecordingOrigin.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
TEST(RecordingOrigin, IsReadAsItWasWritten)
{
  const TestFolder folder;
  writeRecordingOrigin({"/data/scans", "scans2rawlog", {"no times", "two\nlines"}, ""},
                       folder.path());
  EXPECT_EQ(
      "[recording]\ninput = /data/scans\nconverter = scans2rawlog\nwarning_1 = no times\n"
      "warning_2 = two lines\n",
      folder.read("recording.ini"));
  const auto origin = originOfRecording(folder.file("recording.rawlog"));
  ASSERT_TRUE(origin);
  EXPECT_EQ("/data/scans", origin->input);
  EXPECT_EQ("scans2rawlog", origin->converter);
  EXPECT_EQ((std::vector<std::string>{"no times", "two lines"}), origin->warnings);
  EXPECT_EQ("", origin->part);
  writeRecordingOrigin({"/data/scans", "scans2rawlog", {}, "--end 5"}, folder.path());
  EXPECT_EQ("--end 5", originOfRecording(folder.file("recording.rawlog"))->part);
}

TEST(RecordingOrigin, IsThatOfAConvertedRecordingOnly)
{
  const TestFolder folder;
  EXPECT_FALSE(originOfRecording(folder.file("recording.rawlog")));
  EXPECT_FALSE(originOfRecording("recording.rawlog")) << "of the working folder";
  folder.write("recording.ini", "[recording]\ninput = /data/scans\n");
  EXPECT_TRUE(originOfRecording(folder.file("recording.rawlog")));
  EXPECT_FALSE(originOfRecording(folder.file("other.rawlog")));
  folder.write("recording.ini", "no ini\n");
  EXPECT_FALSE(originOfRecording(folder.file("recording.rawlog")));
}
}  // namespace dyslam
