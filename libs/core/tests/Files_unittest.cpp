// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Files.h>
#include <dyslam/core/PendingFile.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class Files : public testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("dyslam_files_" + std::to_string(getpid()));
    fs::create_directories(folder_ / "in");
    writeWhole(path("in/a"), "a");
    fs::create_symlink(folder_ / "in/a", folder_ / "file_link");
    fs::create_directory_symlink(folder_ / "in", folder_ / "folder_link");
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const
  {
    return (folder_ / name).string();
  }

  fs::path folder_;
};

TEST_F(Files, PathsAreComparedWithLinksFollowed)
{
  for (const char* same : {"in/a", "in/../in/./a", "file_link", "folder_link/a"})
  {
    EXPECT_TRUE(isSamePath(path("in/a"), path(same))) << same;
  }
  EXPECT_TRUE(isSamePath(path("folder_link/new"), path("in/new"))) << "there is none yet";
  EXPECT_FALSE(isSamePath(path("in/a"), path("in/new")));
  EXPECT_FALSE(isSamePath(path("in/a"), path("in")));
  EXPECT_FALSE(isSamePath("", ""));
  EXPECT_FALSE(isSamePath("", path("in/a")));
  EXPECT_FALSE(isSamePath(std::string(100000, 'x'), path("in/a")));
}

TEST_F(Files, AFolderHasItselfAndAllBelow)
{
  for (const char* within : {"in", "in/a", "in/new/file", "folder_link/a", "file_link", "./in/."})
  {
    EXPECT_TRUE(isWithin(path(within), path("in"))) << within;
    EXPECT_TRUE(isWithin(path(within), path("folder_link"))) << within;
  }
  for (const char* outside : {"", "input", "in/../b", "new"})
  {
    EXPECT_FALSE(isWithin(path(outside), path("in"))) << outside;
  }
  EXPECT_FALSE(isWithin("", path("in")));
}
}  // namespace
}  // namespace dyslam
