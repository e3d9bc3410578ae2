// SPDX-License-Identifier: BSD-3-Clause
#include "../src/folder/OutputFolder.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
const std::vector<OutputName> names{"effective.ini", "tracks.txt", {"labels", ".label"}};

class OutputFolderTest : public ::testing::Test
{
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  static void write(const fs::path& path, const std::string& text)
  {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  /** The error of making it; empty if there is none. */
  [[nodiscard]] std::string errorOf(bool force = false,
                                    const std::vector<std::string>& inputs = {}) const
  {
    try
    {
      const OutputFolder made(folder_.string(), names, inputs, force);
      return "";
    }
    catch (const UserError& error)
    {
      return error.what();
    }
  }
  [[nodiscard]] bool has(const std::string& name) const { return fs::exists(folder_ / name); }

  const TestFolder test_;
  const fs::path folder_ = test_.file("run");
  const fs::path elsewhere_ = test_.file("elsewhere");
};

TEST_F(OutputFolderTest, OneRunAtATime)
{
  write(folder_ / ".dyslam.lock", "of a run that was killed");
  std::optional<OutputFolder> first(std::in_place, folder_.string(), names,
                                    std::vector<std::string>{}, false);
  EXPECT_TRUE(contains(errorOf(), "another run is writing to it"));
  EXPECT_TRUE(contains(errorOf(true), "another run is writing to it")) << "nor by force";
  first.reset();
  EXPECT_EQ("", errorOf());
  EXPECT_FALSE(has(".dyslam.lock"));
}

TEST_F(OutputFolderTest, FilesOfAnEarlierRunGoAndOthersStay)
{
  write(folder_ / "effective.ini", "[output]\n");
  write(folder_ / "tracks.txt", "old");
  write(folder_ / "labels" / "000007.label", "old");
  write(folder_ / "labels" / "notes.txt", "mine");
  write(folder_ / "notes.txt", "mine");
  EXPECT_EQ("", errorOf());
  EXPECT_FALSE(has("effective.ini") || has("tracks.txt") || has("labels/000007.label"));
  EXPECT_TRUE(has("labels/notes.txt") && has("notes.txt"));
}

TEST_F(OutputFolderTest, WhatNoRunWroteStaysUnlessForced)
{
  write(folder_ / "notes.txt", "mine");
  EXPECT_EQ("", errorOf()) << "other names are in nobody's way";
  write(folder_ / "tracks.txt", "the truth");
  write(folder_ / "labels" / "000000.label", "the truth");
  EXPECT_TRUE(contains(errorOf(), "(tracks.txt, labels)")) << errorOf();
  EXPECT_TRUE(contains(errorOf(), "--force"));
  write(folder_ / "effective.ini", "[other]\nprogram = mine\n");
  EXPECT_TRUE(contains(errorOf(), "effective.ini, tracks.txt, labels")) << errorOf();
  EXPECT_EQ("the truth", readWhole((folder_ / "tracks.txt").string()));
  EXPECT_EQ("the truth", readWhole((folder_ / "labels/000000.label").string()));
  EXPECT_EQ("", errorOf(true));
  EXPECT_FALSE(has("tracks.txt") || has("labels"));
}

TEST_F(OutputFolderTest, NoLinkIsFollowed)
{
  write(folder_ / "effective.ini", "[output]\n");
  write(elsewhere_ / "000000.label", "someone's");
  fs::create_symlink(elsewhere_ / "000000.label", folder_ / "tracks.txt");
  EXPECT_EQ("", errorOf());
  EXPECT_FALSE(fs::is_symlink(folder_ / "tracks.txt"));
  fs::create_directory_symlink(elsewhere_, folder_ / "labels");
  for (const bool force : {false, true})
  {
    EXPECT_TRUE(contains(errorOf(force), "labels: is a link")) << errorOf(force);
  }
  EXPECT_EQ("someone's", readWhole((elsewhere_ / "000000.label").string()));
}

TEST_F(OutputFolderTest, NoInputIsReplaced)
{
  write(folder_ / "effective.ini", "[output]\n");
  write(folder_ / "labels" / "000000.label", "input");
  for (const char* input : {"effective.ini", "labels/000000.label", "labels"})
  {
    const std::string path = (folder_ / input).string();
    EXPECT_TRUE(contains(errorOf(true, {path}), path + ": would be replaced")) << input;
    EXPECT_TRUE(has(input));
  }
  fs::create_directories(elsewhere_);
  fs::create_symlink(folder_ / "effective.ini", elsewhere_ / "my.ini");
  EXPECT_TRUE(contains(errorOf(true, {(elsewhere_ / "my.ini").string()}), "would be replaced"));
}
}  // namespace
}  // namespace dyslam
