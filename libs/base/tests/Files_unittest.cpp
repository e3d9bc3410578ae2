// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "TestFolder.h"

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
    (void)folder_.write("in/a", "a");
    fs::create_symlink(path("in/a"), path("file_link"));
    fs::create_directory_symlink(path("in"), path("folder_link"));
    for (const char* name : {"b", "c", "a"})
    {
      fs::create_directories(listed_ / name);
    }
    writeWhole((listed_ / "b.txt").string(), "x");
    fs::create_symlink("nowhere", listed_ / "link");
  }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }

  const TestFolder folder_;
  const fs::path listed_ = folder_.file("listed");
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

std::vector<std::string> namesOf(const std::vector<fs::directory_entry>& entries)
{
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : entries)
  {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

TEST_F(Files, EntriesComeByName)
{
  const std::vector<std::string> expected{"a", "b", "b.txt", "c", "link"};
  EXPECT_EQ(namesOf(entriesOf(listed_)), expected);
  EXPECT_EQ(namesOf(entriesIfReadable(listed_)), expected);
  EXPECT_EQ(foldersIn(listed_), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_TRUE(entriesOf(listed_ / "a").empty());
}

/** Git leaves such a text in place of a file that is stored in Git LFS. */
TEST_F(Files, GitLfsPointersAreNamed)
{
  const std::string file = path("in/drive.bag");
  const std::string begin = "version https://git-lfs.github.com/spec/";
  writeWhole(file, begin + "v1\noid sha256:" + std::string(64, '0') + "\nsize 990\n");
  try
  {
    (void)readWhole(file);
    ADD_FAILURE();
  }
  catch (const UserError& error)
  {
    EXPECT_EQ(std::string(error.what()),
              file + ": is a Git LFS pointer, not the file itself; run 'git lfs pull' there");
  }
  for (const std::string& content : {std::string("version"), begin + std::string(2000, ' ')})
  {
    writeWhole(file, content);
    EXPECT_EQ(readWhole(file), content);
  }
}

TEST_F(Files, WhatCannotBeListedIsAnErrorThatNamesIt)
{
  for (const fs::path& path : {listed_ / "b.txt", listed_ / "none"})
  {
    EXPECT_TRUE(entriesIfReadable(path).empty());
    EXPECT_THROW((void)foldersIn(path), UserError);
    try
    {
      (void)entriesOf(path);
      ADD_FAILURE() << path;
    }
    catch (const UserError& error)
    {
      EXPECT_EQ(std::string(error.what()).rfind(path.string() + ": cannot be read: ", 0), 0U)
          << error.what();
    }
  }
}
}  // namespace
}  // namespace dyslam
