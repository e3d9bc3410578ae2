// SPDX-License-Identifier: BSD-3-Clause
// Bags that are cut short or damaged.
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/Bag.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "SomeMessages.h"
#include "TestFolder.h"

namespace dyslam
{
TEST(DamagedBags, McapChecksChunks)
{
  const TestFolder folder;
  const auto messages = someMessages(3);
  test::writeMcap(folder.file("x.mcap"), messages, {"none", 3, true});
  std::string bytes = readWhole(folder.file("x.mcap"));
  const std::size_t at = bytes.find(messages[1].data);
  ASSERT_NE(at, std::string::npos);
  bytes[at + messages[1].data.size() / 2] ^= 1;
  const std::string path = folder.write("y.mcap", bytes);
  const std::string message =
      messageOfError<UserError>([&] { (void)dataOf(*openBag(path), "/imu"); });
  EXPECT_TRUE(contains(message, "checksum")) << message;
}

/** A recorder that was killed leaves whole chunks and then whatever. */
TEST(DamagedBags, CutShortAnywhereGivesWholeChunksOrOneError)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  for (const std::string ending : {".bag", ".mcap"})
  {
    for (const std::string compression : {"none", "lz4"})
    {
      const test::BagStyle style{compression, 3, true, true, false};
      const std::string path = folder.file("x" + ending);
      ending == ".bag" ? test::writeRos1Bag(path, messages, style)
                       : test::writeMcap(path, messages, style);
      const std::string whole = folder.read("x" + ending);
      const std::size_t begin = ending == ".bag" ? 4096 : 0;  // before that there is only padding
      std::size_t most = 0;
      for (std::size_t size = begin; size < whole.size(); size += 13)
      {
        const std::string cut = folder.write("cut" + ending, whole.substr(0, size));
        try
        {
          const auto bag = openBag(cut);
          std::vector<std::size_t> all(bag->topics().size());
          for (std::size_t i = 0; i < all.size(); ++i)
          {
            all[i] = i;
          }
          bag->select(all);
          std::size_t count = 0;
          for (BagMessage message; bag->next(message); ++count)
          {
            EXPECT_EQ(messages[count].data, message.data);
          }
          EXPECT_GE(count, most);  // the more there is, the more is read
          most = count;
          EXPECT_FALSE(bag->warnings().empty()) << size;
        }
        catch (const UserError& error)
        {
          EXPECT_TRUE(contains(error.what(), "cut" + ending)) << error.what();
        }
      }
      EXPECT_GE(most, 9U) << ending << compression;
    }
  }
}

/** Whatever bytes are damaged: an error that names the file, or what could be read; never more. */
TEST(DamagedBags, DamagedBytes)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  for (const std::string name : {"x.bag", "y.bag", "x.mcap", "y.mcap", "x.db3"})
  {
    const std::string compression = name[0] == 'x' ? "none" : "lz4";
    if (contains(name, ".db3"))
    {
      test::writeBag(folder.file(name), messages);
    }
    else
    {
      contains(name, ".bag") ? test::writeRos1Bag(folder.file(name), messages, {compression})
                             : test::writeMcap(folder.file(name), messages, {compression});
    }
    const std::string whole = folder.read(name);
    std::size_t refused = 0;
    for (std::size_t at = 0; at < whole.size(); at += contains(name, ".db3") ? 97 : 11)
    {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ 0xFF);
      const std::string path = folder.write("damaged_" + name, damaged);
      try
      {
        const auto bag = openBag(path);
        std::vector<std::size_t> all(bag->topics().size());
        for (std::size_t i = 0; i < all.size(); ++i)
        {
          all[i] = i;
        }
        bag->select(all);
        std::size_t count = 0;
        for (BagMessage message; bag->next(message);)
        {
          ++count;
        }
        EXPECT_LE(count, messages.size());
      }
      catch (const UserError& error)
      {
        ++refused;
        EXPECT_TRUE(contains(error.what(), "damaged_" + name)) << error.what();
      }
    }
    EXPECT_GT(refused, 0U) << name;
  }
}

TEST(DamagedBags, ADamagedRecordOfAChunkIsNamedByItsFirstByte)
{
  const TestFolder folder;
  test::writeRos1Bag(folder.file("x.bag"), someMessages(4), {"none", 4, false});
  std::string bytes = folder.read("x.bag");
  const std::size_t first = bytes.find("op=\x02");
  const std::size_t field = bytes.find("op=\x02", first + 1);
  ASSERT_NE(field, std::string::npos);
  bytes[field + 2] = '?';
  const std::string path = folder.write("y.bag", bytes);
  const auto message = messageOfError<UserError>([&path] { (void)openBag(path); });
  const std::size_t chunk = message.find("chunk at byte ");
  const std::size_t record = message.find(", byte ");
  ASSERT_TRUE(chunk != std::string::npos && record != std::string::npos) << message;
  // Two lengths stand before the field.
  EXPECT_EQ(field - 8,
            std::stoul(message.substr(chunk + 14)) + std::stoul(message.substr(record + 7)))
      << message;
}

TEST(DamagedBags, Errors)
{
  const TestFolder folder;
  const auto message = [](const std::string& path)
  { return messageOfError<UserError>([&path] { (void)openBag(path); }); };
  EXPECT_TRUE(contains(message(folder.file("none.bag")), "none.bag"));
  EXPECT_TRUE(contains(message(folder.write("a.bag", "hello")), "not a ROS 1 bag"));
  EXPECT_TRUE(contains(message(folder.write("b.bag", "#ROSBAG V1.2\nxxxxxxxx")), "migrate"));
  EXPECT_TRUE(contains(message(folder.write("a.mcap", "hello")), "not an mcap file"));
  EXPECT_TRUE(contains(message(folder.write("a.db3", "hello, this is no database")), "a.db3"));
  EXPECT_TRUE(contains(message(folder.write("a.db3.zstd", "")), "end early"));
  EXPECT_TRUE(contains(message(folder.write("a.bag.gz", "")), "gunzip -k " + folder.file("a.bag")));
  // A chunk that announces more than there is allocates nothing for it.
  test::writeMcap(folder.file("c.mcap"), someMessages(4), {"zstd"});
  std::string bytes = folder.read("c.mcap");
  const std::size_t chunk = bytes.find('\x06', 8 + 9 + 16);
  for (std::size_t i = 0; i < 7; ++i)
  {
    bytes[chunk + 9 + 16 + i] = '\x7F';  // the size without compression
  }
  folder.write("c.mcap", bytes);
  const auto bag = openBag(folder.file("c.mcap"));
  bag->select({0});
  BagMessage first;
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { (void)bag->next(first); }), "c.mcap: chunk"));
}
}  // namespace dyslam
