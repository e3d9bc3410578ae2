// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/LabelFiles.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
TEST(LabelFiles, AreInTheFolderOfLabelsOrElseInTheFolderItself)
{
  const TestFolder folder;
  EXPECT_EQ(labelFolderOf(""), std::nullopt);
  EXPECT_EQ(labelFolderOf(folder.file("none")), std::nullopt);
  EXPECT_EQ(labelFolderOf(folder.write("file", "")), std::nullopt);

  folder.write("run/report.json", "{}");
  EXPECT_EQ(labelFolderOf(folder.file("run")), std::nullopt);
  folder.write("run/labels/notes.txt", "");
  EXPECT_EQ(labelFolderOf(folder.file("run")), std::nullopt);
  folder.write("run/000000.label", "");
  EXPECT_EQ(labelFolderOf(folder.file("run")), folder.file("run"));
  folder.write("run/labels/000000.label", "");
  EXPECT_EQ(labelFolderOf(folder.file("run")), folder.file("run/labels"));
  EXPECT_EQ(labelFolderOf(folder.file("run/labels")), folder.file("run/labels"));
}
}  // namespace dyslam
