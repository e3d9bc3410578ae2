// SPDX-License-Identifier: BSD-3-Clause
// Bags that are compressed as a whole.
#include <dyslam/base/Error.h>
#include <dyslam/formats/Bag.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "FullDisk.h"
#include "SomeMessages.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The folder for temporary files, until the object's end. */
class TemporaryFiles
{
 public:
  explicit TemporaryFiles(const std::string& folder)
  {
    if (const char* before = std::getenv("TMPDIR"))
    {
      before_ = before;
    }
    ::setenv("TMPDIR", folder.c_str(), 1);
  }
  ~TemporaryFiles() { before_ ? ::setenv("TMPDIR", before_->c_str(), 1) : ::unsetenv("TMPDIR"); }
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

 private:
  std::optional<std::string> before_;
};
}  // namespace

/** As rosbag2 writes them with --compression-mode file. */
TEST(PackedBags, OnesThatAreCompressedAsAWhole)
{
  const TestFolder folder;
  std::filesystem::create_directories(folder.file("tmp"));
  const TemporaryFiles temporary(folder.file("tmp"));
  const auto isTidy = [&folder] { return std::filesystem::is_empty(folder.file("tmp")); };
  const auto messages = someMessages(10);
  for (const std::string ending : {".db3", ".mcap", ".bag"})
  {
    test::writeBag(folder.file("x" + ending), messages);
    const std::string plain = folder.read("x" + ending);
    std::filesystem::remove(folder.file("x" + ending));
    expectAll(folder.write("x" + ending + ".zstd", test::zstdOf(plain)), messages);
    const std::size_t half = plain.size() / 2;
    expectAll(folder.write("x" + ending + ".zst",
                           test::zstdOf(plain.substr(0, half)) + test::zstdOf(plain.substr(half))),
              messages);
  }
  EXPECT_TRUE(isTidy());

  // Two parts, of which the recorder did not come to compress the last one.
  const auto middle = messages.begin() + 6;
  test::writeSqliteBag(folder.file("whole.db3"), {messages.begin(), middle});
  const std::string first = test::zstdOf(folder.read("whole.db3"));
  folder.write("drive/drive_0.db3.zstd", first);
  test::writeSqliteBag(folder.file("drive/drive_1.db3"), {middle, messages.end()});
  expectAll(folder.file("drive"), messages);

  const auto message = [&folder](const std::string& name)
  { return messageOfError<UserError>([&] { (void)openBag(folder.file(name)); }); };
  folder.write("cut.db3.zstd", first.substr(0, first.size() / 2));
  EXPECT_TRUE(contains(message("cut.db3.zstd"), "cut.db3.zstd: compressed data end early"));
  folder.write("no.db3.zstd", "no zstd at all");
  EXPECT_TRUE(contains(message("no.db3.zstd"), "no.db3.zstd: damaged compressed data ("));
  for (const std::string name : {"no.mcap.zstd", "not.bag.zst", "not.db3.zst"})
  {
    folder.write(name, test::zstdOf(std::string(1000, 'x')));
    EXPECT_EQ(message(name).find(folder.file(name) + ": is not a"), 0U) << message(name);
  }
  {
    const test::FullDisk full;
    const std::string no_room = message("drive");
    EXPECT_TRUE(contains(no_room, "drive_0.db3.zstd: is compressed as a whole")) << no_room;
    EXPECT_TRUE(contains(no_room, "; set TMPDIR to a folder with room")) << no_room;
  }
  EXPECT_TRUE(isTidy());
}

TEST(PackedBags, UnpackingIsReportedAndCanBeEnded)
{
  const TestFolder folder;
  std::filesystem::create_directories(folder.file("tmp"));
  const TemporaryFiles temporary(folder.file("tmp"));
  test::writeBag(folder.file("x.mcap"), someMessages(10));
  const std::string plain = folder.read("x.mcap");
  const std::string packed = folder.write("y.mcap.zstd", test::zstdOf(plain));
  std::vector<BagUnpacking> states;
  (void)openBag(packed, [&states](const BagUnpacking& state) { states.push_back(state); });
  ASSERT_GE(states.size(), 3U);
  EXPECT_EQ(packed, states.front().bag);
  EXPECT_EQ(states.front().folder.rfind(folder.file("tmp/"), 0), 0U) << states.front().folder;
  EXPECT_EQ(0U, states.front().bytes);
  EXPECT_FALSE(states[states.size() - 2].is_done);
  EXPECT_TRUE(states.back().is_done);
  EXPECT_EQ(plain.size(), states.back().bytes);
  EXPECT_EQ(1, states.back().fraction);
  const auto stop = [](const BagUnpacking& state)
  {
    if (state.bytes > 0)
    {
      throw UserError("stop");
    }
  };
  EXPECT_EQ("stop", messageOfError<UserError>([&] { (void)openBag(packed, stop); }));
  EXPECT_TRUE(std::filesystem::is_empty(folder.file("tmp")));
}

/** By the sizes that the packed files state. */
TEST(PackedBags, RoomToUnpackAllPartsIsNeeded)
{
  const TestFolder folder;
  const std::string tmp = std::filesystem::temp_directory_path().string();
  const auto room = static_cast<double>(std::filesystem::space(tmp).available);
  const auto header = [room](double share)
  {
    const auto size = static_cast<std::uint64_t>(share * room);
    std::string bytes = "\x28\xB5\x2F\xFD\xE0";  // a frame that states its size in eight bytes
    for (unsigned i = 0; i < 64; i += 8)
    {
      bytes += static_cast<char>((size >> i) & 0xFFU);
    }
    return bytes;
  };
  const auto message = [&folder](const std::string& name)
  { return messageOfError<UserError>([&] { (void)openBag(folder.file(name)); }); };
  folder.write("x.db3.zstd", header(2));
  folder.write("parts/x_0.db3.zstd", header(0.75));
  folder.write("parts/x_1.db3.zstd", header(0.75));
  const std::string cannot = ".db3.zstd: is compressed as a whole and cannot be unpacked to " + tmp;
  EXPECT_TRUE(contains(message("x.db3.zstd"), cannot + ": it has ")) << message("x.db3.zstd");
  EXPECT_TRUE(contains(message("parts"), "x_0" + cannot + ": it and the other parts have "))
      << message("parts");
  folder.write("parts/x_0.db3.zstd", header(0.01));
  folder.write("parts/x_1.db3.zstd", header(0.01));
  EXPECT_FALSE(contains(message("parts"), "cannot be unpacked")) << message("parts");
}
}  // namespace dyslam
