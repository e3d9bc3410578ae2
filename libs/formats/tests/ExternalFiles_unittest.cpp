// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/ExternalFiles.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
TEST(ExternalFiles, AreInTheFirstFolderThatIsThere)
{
  const TestFolder folder;
  const std::string rawlog = folder.write("day.1.rawlog", "");
  EXPECT_EQ(externalStorageFolder(rawlog), folder.file("day.1_Images"));
  EXPECT_EQ(externalFolderOf(rawlog), std::nullopt);
  folder.write("day.1_Images", "a file");
  EXPECT_EQ(externalFolderOf(rawlog), std::nullopt);
  for (const std::string name : {"day.1_imgs", "day.1_img", "day.1_images"})
  {
    folder.write(name + "/0.bin", "");
    EXPECT_EQ(externalFolderOf(rawlog), folder.file(name));
  }
  std::filesystem::remove(folder.file("day.1_Images"));
  folder.write("day.1_Images/0.bin", "");
  EXPECT_EQ(externalFolderOf(rawlog), externalStorageFolder(rawlog));
  EXPECT_EQ(externalFolderOf("nowhere.rawlog"), std::nullopt);
}
}  // namespace dyslam
