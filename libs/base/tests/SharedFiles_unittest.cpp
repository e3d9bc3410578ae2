// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** Works in a new, empty folder. */
class SharedFiles : public testing::Test
{
 protected:
  static std::string found(const std::string& path)
  {
    return findGivenOrShared(path, "config_files", ".ini");
  }

 private:
  const TestFolder folder_;
  const WorkingFolder within_{folder_.path()};
};

TEST_F(SharedFiles, AreFoundByNameWithOrWithoutExtension)
{
  for (const char* name : {"kitti64", "kitti64.ini"})
  {
    EXPECT_EQ(fs::path(found(name)).filename(), "kitti64.ini");
    EXPECT_TRUE(fs::is_regular_file(found(name)));
  }
}

TEST_F(SharedFiles, GivenFileComesFirstButNoFolder)
{
  fs::create_directory("kitti64");
  EXPECT_EQ(fs::path(found("kitti64")).filename(), "kitti64.ini");
  std::ofstream("kitti64.ini") << "[preprocess]\n";
  EXPECT_EQ(found("kitti64.ini"), "kitti64.ini");
}

TEST_F(SharedFiles, ANameThatIsAlsoInTheWorkingFolderIsTold)
{
  const auto noteOf = [](const std::string& path)
  { return sharedInsteadOf(path, "config_files", ".ini", "--config"); };
  EXPECT_EQ(noteOf("kitti64"), "");
  fs::create_directory("kitti64");
  const std::string used =
      "--config = kitti64: is the name of shipped ones, " + found("kitti64") + ", which are used; ";
  EXPECT_EQ(noteOf("kitti64"), used + "the folder kitti64 is not: give a file in it with its path");
  std::ofstream("kitti64.ini") << "[preprocess]\n";
  EXPECT_EQ(noteOf("kitti64"), used + "give ./kitti64.ini for the file of this folder");
  EXPECT_EQ(noteOf("kitti64.ini"), "") << "the file itself is used";
  EXPECT_EQ(found("./kitti64.ini"), "./kitti64.ini");
  fs::create_directory("mine");
  EXPECT_EQ(noteOf("mine"), "") << "nothing is shipped with that name";
  EXPECT_EQ(noteOf(""), "");
}

TEST_F(SharedFiles, AFolderThatIsNotFoundNamesTheVariable)
{
  try
  {
    (void)findGivenOrShared("kitti64", "no_such_folder", ".ini");
    FAIL();
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("set DYSLAM_SHARE"), std::string::npos)
        << error.what();
  }
}

TEST_F(SharedFiles, TheFoldersOfTheSearchBeginWithTheVariable)
{
  const char* given = std::getenv("DYSLAM_SHARE");
  const std::string before = given == nullptr ? "" : given;
  const std::string mine = fs::current_path().string();
  ASSERT_EQ(setenv("DYSLAM_SHARE", mine.c_str(), 1), 0);
  const std::string searched = searchedFolders();
  EXPECT_EQ(searched.find(mine + ", /"), 0U) << searched;
  (void)(before.empty() ? unsetenv("DYSLAM_SHARE") : setenv("DYSLAM_SHARE", before.c_str(), 1));
}

TEST_F(SharedFiles, AVariableThatNamesNoFolderIsAnError)
{
  const char* given = std::getenv("DYSLAM_SHARE");
  const std::string before = given == nullptr ? "" : given;
  ASSERT_EQ(setenv("DYSLAM_SHARE", "/no/such/folder", 1), 0);
  try
  {
    (void)found("kitti64");
    ADD_FAILURE() << "found without the folder";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("DYSLAM_SHARE = /no/such/folder: is not a folder"),
              std::string::npos)
        << error.what();
  }
  (void)(before.empty() ? unsetenv("DYSLAM_SHARE") : setenv("DYSLAM_SHARE", before.c_str(), 1));
}

TEST_F(SharedFiles, WeightsForNonCommercialUseNameTheirPackage)
{
  const auto message = [](const std::string& path, const std::string& extension)
  {
    return messageOfError<UserError>(
        [&] { (void)findGivenOrShared(path, "no_such_folder", extension, "dylo.weights"); });
  };
  const std::string package = "dyslam-weights-noncommercial";
  for (const char* path : {"dylo", "dylo.safetensors", "dyseg", "dyseg.safetensors"})
  {
    const std::string text = message(path, ".safetensors");
    EXPECT_EQ(0U, text.find(std::string("dylo.weights = ") + path + ": no such file; ")) << text;
    EXPECT_TRUE(contains(text, "of the Debian packages, " + package + " has these weights"))
        << text;
  }
  for (const char* path : {"dyseg_simulated", "dylo2", "./dylo", "out/dylo.safetensors", ""})
  {
    EXPECT_FALSE(contains(message(path, ".safetensors"), package)) << path;
  }
  EXPECT_FALSE(contains(message("dylo", ".ini"), package));
}

TEST_F(SharedFiles, UnknownNameListsTheKnown)
{
  try
  {
    (void)found("no_such");
    FAIL();
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("kitti64.ini"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)found("./kitti64"), UserError);
}

TEST_F(SharedFiles, OnlyInisOfTheProgramAreListed)
{
  const auto listed = [](const std::string& program)
  {
    try
    {
      (void)findGivenOrShared("no_such", "config_files", ".ini", "", program);
    }
    catch (const UserError& error)
    {
      return std::string(error.what());
    }
    return std::string("found");
  };
  const std::string start = "no_such: no such file; give a path or one of: ";
  EXPECT_EQ(start + "fast.ini, handheld.ini, kitti64.ini, paper64.ini, solid_state.ini, vlp16.ini",
            listed("dyslam"));
  EXPECT_EQ(start + "kitti_mot.ini", listed("dyslam-eval"));
  EXPECT_EQ(start + "train_dylo.ini, train_dylo_simulated.ini", listed("dyslam-train dylo"));
  EXPECT_EQ(start + "train_dyseg.ini, train_dyseg_simulated.ini", listed("dyslam-train dyseg"));
  EXPECT_EQ(start + "splits.ini", listed("dyslam-train splits"));
}
}  // namespace
}  // namespace dyslam
