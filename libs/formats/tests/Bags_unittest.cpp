// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>

#include "BagWriters.h"
#include "FullDisk.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::BagStyle;
using test::TestMessage;

/** Two topics that alternate, and one at the end. */
std::vector<TestMessage> someMessages(std::size_t count)
{
  std::vector<TestMessage> messages;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double stamp = 1.6e9 + 0.5 * static_cast<double>(i);
    const std::string data = "message " + std::to_string(i) + std::string(100 + i, 'x');
    messages.push_back({i % 2 == 0 ? "/points" : "/imu",
                        i % 2 == 0 ? "sensor_msgs/PointCloud2" : "sensor_msgs/Imu", stamp, data});
  }
  messages.push_back({"/late", "std_msgs/String", 1.6e9 + 100, "late"});
  return messages;
}

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

std::size_t topicAt(const Bag& bag, const std::string& name)
{
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    if (bag.topics()[i].name == name)
    {
      return i;
    }
  }
  ADD_FAILURE() << "no topic " << name;
  return 0;
}

void expectInThisOrder(Bag& bag, const std::vector<TestMessage>& messages)
{
  std::vector<std::size_t> all(bag.topics().size());
  std::iota(all.begin(), all.end(), 0U);
  for (int time = 0; time < 2; ++time)
  {
    bag.select(all);
    BagMessage message;
    for (const TestMessage& expected : messages)
    {
      ASSERT_TRUE(bag.next(message));
      EXPECT_EQ(expected.data, message.data);
      EXPECT_EQ(expected.topic, bag.topics()[message.topic].name);
    }
    EXPECT_FALSE(bag.next(message));
    EXPECT_DOUBLE_EQ(bag.progress(), 1);
  }
  EXPECT_TRUE(bag.warnings().empty());
}

std::vector<std::string> dataOf(Bag& bag, const std::string& topic)
{
  bag.select({topicAt(bag, topic)});
  std::vector<std::string> data;
  BagMessage message;
  while (bag.next(message))
  {
    data.emplace_back(message.data);
  }
  return data;
}

void expectAll(const std::string& path, const std::vector<TestMessage>& messages)
{
  const auto bag = openBag(path);
  ASSERT_EQ(3U, bag->topics().size()) << path;
  const BagTopic topic = bag->topics()[topicAt(*bag, "/points")];
  EXPECT_EQ("sensor_msgs/PointCloud2", topic.type);
  EXPECT_EQ(5U, topic.messages);
  EXPECT_NEAR(1.6e9, topic.first, 1e-6);
  EXPECT_NEAR(1.6e9 + 4, topic.last, 1e-6);
  EXPECT_EQ(1U, bag->topics()[topicAt(*bag, "/late")].messages);
  std::vector<std::string> expected;
  for (const TestMessage& message : messages)
  {
    if (message.topic == "/points")
    {
      expected.push_back(message.data);
    }
  }
  EXPECT_EQ(expected, dataOf(*bag, "/points")) << path;
  EXPECT_EQ(expected, dataOf(*bag, "/points")) << "a second time: " << path;
  EXPECT_EQ(std::vector<std::string>{"late"}, dataOf(*bag, "/late")) << path;
  EXPECT_TRUE(bag->warnings().empty());
}
}  // namespace

TEST(Bags, Ros1OfEachCompression)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  for (const std::string compression : {"none", "bz2", "lz4"})
  {
    for (const bool index : {true, false})
    {
      test::writeRos1Bag(folder.file("x.bag"), messages, {compression, 3, index});
      expectAll(folder.file("x.bag"), messages);
      EXPECT_EQ(RosEncoding::ros1, openBag(folder.file("x.bag"))->topics().front().encoding);
    }
  }
}

TEST(Bags, McapOfEachCompressionWithAndWithoutIndexOrChunks)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  for (const std::string compression : {"none", "lz4", "zstd"})
  {
    for (const bool index : {true, false})
    {
      test::writeMcap(folder.file("x.mcap"), messages, {compression, 3, index});
      expectAll(folder.file("x.mcap"), messages);
    }
  }
  test::writeMcap(folder.file("x.mcap"), messages, {"none", 3, false, false});
  expectAll(folder.file("x.mcap"), messages);
  EXPECT_EQ(RosEncoding::cdr, openBag(folder.file("x.mcap"))->topics().front().encoding);
  test::writeMcap(folder.file("x.mcap"), messages, {}, "ros1");
  expectAll(folder.file("x.mcap"), messages);
  EXPECT_EQ(RosEncoding::ros1, openBag(folder.file("x.mcap"))->topics().front().encoding);
  test::writeMcap(folder.file("x.mcap"), messages, {}, "protobuf");
  EXPECT_EQ(RosEncoding::other, openBag(folder.file("x.mcap"))->topics().front().encoding);
}

TEST(Bags, ProgressWithinAChunk)
{
  const TestFolder folder;
  const auto messages = someMessages(9);
  for (const std::string ending : {".bag", ".mcap"})
  {
    const BagStyle one_chunk{"none", 100};
    ending == ".bag" ? test::writeRos1Bag(folder.file("x.bag"), messages, one_chunk)
                     : test::writeMcap(folder.file("x.mcap"), messages, one_chunk);
    const auto bag = openBag(folder.file("x" + ending));
    std::vector<std::size_t> all(bag->topics().size());
    std::iota(all.begin(), all.end(), 0U);
    bag->select(all);
    BagMessage message;
    double last = 0;
    for (std::size_t i = 0; i < messages.size(); ++i)
    {
      ASSERT_TRUE(bag->next(message));
      EXPECT_GT(bag->progress(), last);
      EXPECT_NEAR(0.1 * static_cast<double>(i + 1), bag->progress(), 0.3) << ending << i;
      last = bag->progress();
    }
    EXPECT_LT(last, 1 + 1e-9);
  }
}

TEST(Bags, McapChecksChunks)
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

TEST(Bags, SqlitePlainAndCompressed)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  for (const bool packed : {false, true})
  {
    test::writeSqliteBag(folder.file("x.db3"), messages, packed);
    expectAll(folder.file("x.db3"), messages);
  }
}

TEST(Bags, AFolderIsOneRecording)
{
  const TestFolder folder;
  auto messages = someMessages(10);
  const std::vector<TestMessage> first(messages.begin(), messages.begin() + 4);
  const std::vector<TestMessage> second(messages.begin() + 4, messages.end());
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    std::filesystem::create_directories(folder.file(ending));
    folder.write(ending + "/metadata.yaml", "");
    test::writeBag(folder.file(ending + "/x_10" + ending), second);
    test::writeBag(folder.file(ending + "/x_9" + ending), first);
    EXPECT_TRUE(isBag(folder.file(ending)));
    expectAll(folder.file(ending), messages);
  }
  test::writeBag(folder.file(".bag/x_9.mcap"), first);
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)openBag(folder.file(".bag")); }),
                       "two kinds"));
}

TEST(Bags, PartsWithDifferentTopicsAreReadSideBySide)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  std::vector<std::vector<TestMessage>> parts(3);  // one of /imu, two of the others
  for (std::size_t i = 0; i < messages.size(); ++i)
  {
    parts[messages[i].topic == "/imu" ? 0 : i < 5 ? 1 : 2].push_back(messages[i]);
  }
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    std::filesystem::create_directories(folder.file(ending));
    test::writeBag(folder.file(ending + "/imu" + ending), parts[0]);
    test::writeBag(folder.file(ending + "/lidar_9" + ending), parts[1]);
    test::writeBag(folder.file(ending + "/lidar_10" + ending), parts[2]);
    expectInThisOrder(*openBag(folder.file(ending)), messages);
  }
}

/** As scripts write them that put one bag behind another. */
TEST(Bags, TopicsBehindEachOtherAreReadSideBySide)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  std::vector<TestMessage> by_topic;
  for (const std::string topic : {"/imu", "/late", "/points"})
  {
    std::copy_if(messages.begin(), messages.end(), std::back_inserter(by_topic),
                 [&topic](const TestMessage& message) { return message.topic == topic; });
  }
  for (const std::string ending : {".bag", ".mcap"})
  {
    test::writeBag(folder.file("x" + ending), by_topic);
    expectInThisOrder(*openBag(folder.file("x" + ending)), messages);
  }
}

TEST(Bags, TheOrderOfTheFileCountsWhereTheClockWasSet)
{
  const TestFolder folder;
  auto messages = someMessages(10);
  for (std::size_t i = 6; i < messages.size(); ++i)
  {
    messages[i].stamp -= 1000;
  }
  for (const std::string ending : {".bag", ".mcap"})
  {
    test::writeBag(folder.file("x" + ending), messages);
    expectInThisOrder(*openBag(folder.file("x" + ending)), messages);
  }
}

TEST(Bags, CopiesInAFolderAreLeftOut)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  std::filesystem::create_directories(folder.file("a"));
  test::writeBag(folder.file("a/x.bag"), messages);
  test::writeBag(folder.file("a/x.orig.bag"), messages);
  folder.write("a/x.bag.zstd", "packed");
  folder.write("a/._x.bag", "of macOS");
  expectAll(folder.file("a"), messages);
  test::writeBag(folder.file("a/y.bag"), messages);
  const auto warnings = openBag(folder.file("a"))->warnings();
  ASSERT_EQ(1U, warnings.size());
  EXPECT_TRUE(contains(warnings[0], "a/y.bag: its messages of /points begin before"));
  folder.write("a/z.bag.gz", "packed");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)openBag(folder.file("a")); }),
                       "gunzip -k " + folder.file("a") + "/*.gz"));
}

/** As rosbag2 writes them with --compression-mode file. */
TEST(Bags, OnesThatAreCompressedAsAWhole)
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

TEST(Bags, UnpackingIsReportedAndCanBeEnded)
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
TEST(Bags, RoomToUnpackAllPartsIsNeeded)
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

TEST(Bags, OneThatItsRecorderHasNotClosed)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  test::writeRos1Bag(folder.file("x.bag"), messages);
  std::filesystem::rename(folder.file("x.bag"), folder.file("x.bag.active"));
  EXPECT_EQ(RecordingKind::bag, recordingKind(folder.file("x.bag.active")));
  expectAll(folder.file("x.bag.active"), messages);
}

TEST(Bags, Listing)
{
  const TestFolder folder;
  test::writeRos1Bag(folder.file("x.bag"), someMessages(10));
  EXPECT_EQ(
      "topic    type                     messages  rate [1/s]  points  frame\n"
      "/points  sensor_msgs/PointCloud2         5        1.00       0  -  <- taken without "
      "--topic\n"
      "/imu     sensor_msgs/Imu                 5        1.00       -  -  <- for "
      "--imu-topic\n"
      "/late    std_msgs/String                 1           -       -  -\n"
      "duration 100.00 s, from 1600000000.000 s since 1970\n",
      listingOf(*openBag(folder.file("x.bag"))));
}

/** A recorder that was killed leaves whole chunks and then whatever. */
TEST(Bags, CutShortAnywhereGivesWholeChunksOrOneError)
{
  const TestFolder folder;
  const auto messages = someMessages(10);
  for (const std::string ending : {".bag", ".mcap"})
  {
    for (const std::string compression : {"none", "lz4"})
    {
      const BagStyle style{compression, 3, true, true, false};
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
TEST(Bags, DamagedBytes)
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

TEST(Bags, ADamagedRecordOfAChunkIsNamedByItsFirstByte)
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

TEST(Bags, Errors)
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

TEST(Bags, AdviceForRecordings)
{
  const TestFolder folder;
  EXPECT_EQ("is a ROS bag; make a rawlog of it first: scans2rawlog -i a/b.mcap -o b.rawlog",
            conversionAdvice("a/b.mcap"));
  EXPECT_EQ("is a network capture; make a rawlog of it first: scans2rawlog -i b.pcap -o b.rawlog",
            conversionAdvice("b.pcap"));
  EXPECT_EQ("", conversionAdvice("b.rawlog"));
  EXPECT_EQ("", conversionAdvice("none"));
  folder.write("scans/1.bin", "");
  EXPECT_TRUE(contains(conversionAdvice(folder.file("scans")), "scans2rawlog"));
  folder.write("kitti/velodyne/1.bin", "");
  EXPECT_TRUE(contains(conversionAdvice(folder.file("kitti")), "kitti2rawlog --kind odometry"));
}

TEST(Bags, OfficialLayoutsOfKitti)
{
  const TestFolder folder;
  const auto kindOf = [&folder](const std::string& name)
  { return officialKittiKind(folder.file(name)); };
  folder.write("drive_sync/velodyne_points/data/1.bin", "");
  EXPECT_EQ(KittiKind::raw, kindOf("drive_sync"));
  folder.write("testing/velodyne/0000/1.bin", "");
  EXPECT_EQ(KittiKind::tracking, kindOf("testing"));
  folder.write("sequences/00/velodyne/1.bin", "");
  EXPECT_EQ(KittiKind::odometry, kindOf("sequences/00"));
  folder.write("plain/velodyne/1.bin", "");
  EXPECT_FALSE(kindOf("plain"));
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("plain")));
  EXPECT_FALSE(kittiKindOf(folder.file("sequences")));
  const WorkingFolder within(folder.file("sequences"));
  EXPECT_EQ(KittiKind::odometry, officialKittiKind("00"));
  EXPECT_EQ(KittiKind::odometry, officialKittiKind("00/"));
  const WorkingFolder deeper("00");
  EXPECT_EQ(KittiKind::odometry, officialKittiKind("."));
}

TEST(Bags, KindsOfRecordings)
{
  const TestFolder folder;
  const auto kindOf = [&folder](const std::string& name)
  { return recordingKind(folder.file(name)); };
  EXPECT_EQ(RecordingKind::bag, kindOf("a.db3"));
  EXPECT_EQ(RecordingKind::capture, kindOf("A.PCAPNG"));
  EXPECT_EQ(RecordingKind::capture, kindOf("a.pcapng.gz"));
  EXPECT_EQ(RecordingKind::bag, kindOf("a.mcap.zst"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("a.rawlog.gz"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("a.rawlog"));
  EXPECT_EQ(RecordingKind::unknown, kindOf("a.pcd"));
  folder.write("recording/metadata.yaml", "");
  EXPECT_EQ(RecordingKind::unknown, kindOf("recording"));
  folder.write("recording/recording_0.mcap", "");
  EXPECT_EQ(RecordingKind::bag, kindOf("recording"));
  folder.write("scans/1.pcd", "");
  EXPECT_EQ(RecordingKind::scans, kindOf("scans"));
  folder.write("drive_sync/velodyne_points/data/1.bin", "");
  EXPECT_EQ(RecordingKind::kitti, kindOf("drive_sync"));
  EXPECT_EQ(KittiKind::raw, kittiKindOf(folder.file("drive_sync")));
  folder.write("plain/velodyne/1.bin", "");
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("plain")));
  folder.write("plain/oxts.txt", "");
  EXPECT_EQ(KittiKind::raw, kittiKindOf(folder.file("plain")));
  folder.write("sequences/00/velodyne/1.bin", "");
  folder.write("sequences/00/oxts.txt", "");
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("sequences/00")));
  EXPECT_EQ(KittiKind::odometry, kittiKindOf(folder.file("sequences/00/")));
  folder.write("testing/velodyne/0000/1.bin", "");
  EXPECT_EQ(KittiKind::tracking, kittiKindOf(folder.file("testing")));
  folder.write("pcd/velodyne/1.pcd", "");
  folder.write("pcd/oxts.txt", "");
  EXPECT_EQ(RecordingKind::unknown, kindOf("pcd"));
  EXPECT_EQ(RecordingKind::scans, kindOf("pcd/velodyne"));
  folder.write("pcd/velodyne/1.bin", "");
  EXPECT_EQ(KittiKind::raw, kittiKindOf(folder.file("pcd")));
}
}  // namespace dyslam
