// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/train/DataText.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
using Words = std::vector<std::string>;

TEST(DataText, FieldsAreTrimmedAndEmptyOnesStay)
{
  EXPECT_EQ(splitFields(" a b ;;\tc", ';'), (Words{"a b", "", "c"}));
  EXPECT_EQ(listItems(" a b ;;\tc; ", ';'), (Words{"a b", "c"}));
  EXPECT_TRUE(listItems("", ',').empty());
}

TEST(DataText, NumbersAreNothingElse)
{
  EXPECT_DOUBLE_EQ(numberOf("-2.5e1"), -25);
  EXPECT_EQ(wholeNumberOf("80"), 80);
  EXPECT_THROW((void)wholeNumberOf("80x"), std::logic_error);
  EXPECT_THROW((void)wholeNumberOf("8.5"), std::logic_error);
  EXPECT_THROW((void)numberOf("1,5"), std::logic_error);
  EXPECT_THROW((void)numberOf(""), std::logic_error);
  EXPECT_THROW((void)numberOf("nan"), std::logic_error);
  EXPECT_THROW((void)numberOf("1e999"), std::logic_error);
}

TEST(DataText, PathsAreInTheFolderOfTheDataOrAbsolute)
{
  EXPECT_EQ(dataPath("/data", "run/velodyne"), "/data/run/velodyne");
  EXPECT_EQ(dataPath("/data", "/mine/run"), "/mine/run");
  EXPECT_EQ(dataPath("", "run"), "run");
}

TEST(DataText, LogsGoOnBehindTheLastStep)
{
  const std::string file = testing::TempDir() + "log.csv";
  std::filesystem::remove(file);
  const auto content = [&] { return readWhole(file); };
  EXPECT_EQ(beginLog(file, "step,loss", 0), -1);
  EXPECT_EQ(content(), "step,loss\n");
  appendRows(file, {"10,0.5", "20,0.4"});
  appendRows(file, {"30,0.3"});
  EXPECT_EQ(content(), "step,loss\n10,0.5\n20,0.4\n30,0.3\n");
  EXPECT_EQ(beginLog(file, "step,loss", 20), 20);
  EXPECT_EQ(content(), "step,loss\n10,0.5\n20,0.4\n");
}

TEST(DataText, ARowThatWasNotWrittenToItsEndIsRemoved)
{
  const std::string file = testing::TempDir() + "torn.csv";
  std::ofstream(file) << "step,loss\n10,0.5\n1";  // of 1000,0.4
  EXPECT_EQ(beginLog(file, "step,loss", 20), 10);
  EXPECT_EQ(readWhole(file), "step,loss\n10,0.5\n");
}

TEST(DataText, RowsThatCannotBeWrittenAreAnError)
{
  const std::string file = testing::TempDir() + "no_such_folder/log.csv";
  for (const std::string& path : {file, std::string("/dev/full")})
  {
    try
    {
      appendRows(path, {"10,0.5"});
      FAIL() << path;
    }
    catch (const UserError& error)
    {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

TEST(DataText, ALeadingVariableIsReadFromTheEnvironment)
{
  ::setenv("DYSLAM_TEST_FOLDER", "/some/where", 1);
  ::unsetenv("DYSLAM_TEST_FOLDER2");
  EXPECT_EQ(dataFolder("$DYSLAM_TEST_FOLDER", "f"), "/some/where");
  EXPECT_EQ(dataFolder("$DYSLAM_TEST_FOLDER/run", "f"), "/some/where/run");
  EXPECT_EQ(dataFolder("run/$DYSLAM_TEST_FOLDER", "f"), "run/$DYSLAM_TEST_FOLDER");
  EXPECT_THROW((void)dataFolder("$DYSLAM_TEST_FOLDER2/run", "f"), UserError);
}

TEST(DataText, StartWeightsAreAFileOrShipped)
{
  const TestFolder folder;
  EXPECT_EQ(startWeights(""), "");
  const std::string given = folder.write("mine.safetensors", "weights");
  EXPECT_EQ(startWeights(given), given);
  const std::string shipped = startWeights("dyseg_simulated");
  EXPECT_TRUE(std::filesystem::is_regular_file(shipped)) << shipped;
  EXPECT_EQ(std::filesystem::path(shipped).filename(), "dyseg_simulated.safetensors");
  const auto refusal = [](const std::string& start)
  { return messageOfError<UserError>([&] { (void)startWeights(start); }); };
  EXPECT_EQ(refusal(folder.path()),
            "--start " + folder.path() + ": is a folder; give its file of weights");
  EXPECT_NE(refusal(folder.file("none.safetensors")).find("none.safetensors: no such file"),
            std::string::npos);
}
}  // namespace
}  // namespace dyslam
