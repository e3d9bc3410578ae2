// SPDX-License-Identifier: BSD-3-Clause
#include "../src/outputs/StreamedFile.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "FullDisk.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr const char* name = "rows.csv";
constexpr const char* growing = "rows.csv.tmp";

TEST(StreamedFile, GrowsUnderATemporaryName)
{
  const TestFolder folder;
  StreamedFile file;
  file.open(folder.file(name), "header\n");
  file.write("1\n");
  EXPECT_EQ(folder.read(growing), "header\n1\n");
  file.write("2\n");
  file.close();
  EXPECT_EQ(folder.read(name), "header\n1\n2\n");
  EXPECT_FALSE(std::filesystem::exists(folder.file(growing)));
}

TEST(StreamedFile, WritesLaterWhatAFullDiskDidNotTake)
{
  const TestFolder folder;
  StreamedFile file;
  file.open(folder.file(name), "header\n");
  {
    const test::FullDisk full(10);
    file.write("first\n");
    file.write("second\n");
  }
  file.write("third\n");
  EXPECT_EQ(folder.read(growing), "header\nfirst\nsecond\nthird\n");
  {
    const test::FullDisk full(10);
    file.write("fourth\n");
  }
  file.close();
  EXPECT_EQ(folder.read(name), "header\nfirst\nsecond\nthird\nfourth\n");
}

TEST(StreamedFile, OnADiskThatStaysFullItIsAnError)
{
  const TestFolder folder;
  {
    StreamedFile file;
    file.open(folder.file(name), "header\n");
    const test::FullDisk full(10);
    file.write("first\n");
    EXPECT_THROW(file.close(), UserError);
    StreamedFile other;
    EXPECT_THROW(other.open(folder.file("other.csv"), "a long header\n"), UserError);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(StreamedFile, AResumedRunGoesOnWithWhatAFullDiskDidNotTake)
{
  const TestFolder folder;
  StateArchive state;
  {
    StreamedFile file;
    file.open(folder.file(name), "header\n");
    const test::FullDisk full(10);
    file.write("first\n");
    file.exchangeState(folder.file(name), state);
    file.write("lost\n");
    EXPECT_THROW(file.close(), UserError);
  }
  EXPECT_TRUE(std::filesystem::exists(folder.file(growing))) << "the state needs it";
  StateArchive saved{std::string_view(state.bytes())};
  StreamedFile file;
  file.exchangeState(folder.file(name), saved);
  file.write("second\n");
  file.close();
  EXPECT_EQ(folder.read(name), "header\nfirst\nsecond\n");
}
}  // namespace
}  // namespace dyslam
