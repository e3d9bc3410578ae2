// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
std::vector<std::string> namesOf(const std::vector<std::string>& files)
{
  std::vector<std::string> names;
  for (const std::string& file : files)
  {
    names.push_back(std::filesystem::path(file).filename().string());
  }
  return names;
}
}  // namespace

TEST(ScanFiles, RingsBesideBin)
{
  const TestFolder folder;
  writeBin(folder.file("a.bin"), {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  folder.write("a.ring", std::string("\x05\x00\xff", 3));
  EXPECT_EQ((std::vector<std::uint16_t>{5, 0, 255}), readBin(folder.file("a.bin")).ring);
  folder.write("a.ring", "xx");
  EXPECT_THROW((void)readBin(folder.file("a.bin")), UserError);
}

TEST(ScanFiles, ListsInNumericalOrder)
{
  const TestFolder folder;
  for (const char* name : {"10.bin", "9.bin", "007.bin", "100.bin", "notes.txt"})
  {
    folder.write(name, "");
  }
  const std::vector<std::string> expected{"007.bin", "9.bin", "10.bin", "100.bin"};
  EXPECT_EQ(expected, namesOf(listCloudFiles(folder.path())));
  folder.write("a.pcd", "");
  EXPECT_THROW((void)listCloudFiles(folder.path()), UserError);
  EXPECT_EQ(expected, namesOf(listBinFiles(folder.path())));
  EXPECT_THROW((void)listCloudFiles(folder.file("none")), UserError);
  EXPECT_THROW((void)listBinFiles(folder.file("none")), UserError);
  std::filesystem::create_directories(folder.file("empty"));
  EXPECT_THROW((void)listCloudFiles(folder.file("empty")), UserError);
  EXPECT_THROW((void)listBinFiles(folder.file("empty")), UserError);
}

// Reading the first page of one's own memory fails with EIO: an end that is not the file's.
TEST(ReadErrors, AreNotTheEndOfTheFile)
{
  const std::string path = "/proc/self/mem";
  if (!std::filesystem::exists(path))
  {
    GTEST_SKIP() << "needs Linux's /proc";
  }
  const auto expectError = [](const auto& read)
  {
    const std::string message = messageOfError<UserError>(read);
    EXPECT_TRUE(contains(message, "cannot be read to its end: Input/output error")) << message;
  };
  expectError([&] { (void)readWhole(path); });
  expectError([&] { (void)readBin(path); });
  expectError([&] { (void)readLabels(path); });
  expectError([&] { (void)readTum(path); });
  expectError([&] { (void)readTimes(path); });
}
}  // namespace dyslam
