// SPDX-License-Identifier: BSD-3-Clause
// The mcap files that are written: read back by the reader of bags, and record by record by the
// specification of the format.
#include <dyslam/base/Error.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/BagWriter.h>
#include <dyslam/formats/RosWriter.h>
#include <gtest/gtest.h>
#include <libdeflate.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::uint64_t second_ns = 1000000000;
constexpr std::uint64_t bag_begin = 1600000000 * second_ns;  // [ns]

BagWriterTopic writerTopic(const std::string& name, RosType type, bool latched = false)
{
  return {name, rosTypeName(type), rosDefinition(type), latched};
}

/** Bytes that do not get much smaller. */
std::string noise(std::size_t size, std::uint32_t seed)
{
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i)
  {
    seed = seed * 1664525U + 1013904223U;
    bytes += static_cast<char>(seed >> 24U);
  }
  return bytes;
}

/** Two topics that alternate, in several chunks, and one message that is latched. */
std::vector<std::string> writeSomeBag(const std::string& path)
{
  BagWriter writer(path);
  const auto points = writer.addTopic(writerTopic("/points", RosType::point_cloud2));
  const auto unused = writer.addTopic(writerTopic("/unused", RosType::path));
  const auto map = writer.addTopic(writerTopic("/map", RosType::point_cloud2, true));
  const auto imu = writer.addTopic(writerTopic("/imu", RosType::imu));
  EXPECT_NE(points, unused);
  std::vector<std::string> clouds;
  writer.write(map, bag_begin, "the map");
  for (std::uint32_t i = 0; i < 10; ++i)
  {
    const std::uint64_t stamp = bag_begin + i * second_ns / 2;
    clouds.push_back(noise(1500000 + i, i));
    writer.write(points, stamp, clouds.back());
    writer.write(imu, stamp + second_ns / 4, "imu " + std::to_string(i));
  }
  writer.close();
  return clouds;
}

template <typename Number>
Number numberAt(std::string_view bytes, std::size_t at)
{
  Number value{};
  EXPECT_LE(at + sizeof value, bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/** A record: where it begins in the file, its kind and content. */
struct McapPart
{
  std::size_t at = 0;
  int op = 0;
  std::string_view content;

  [[nodiscard]] std::size_t size() const { return 9 + content.size(); }
};

std::vector<McapPart> recordsOf(std::string_view bytes, std::size_t begin, std::size_t end)
{
  std::vector<McapPart> records;
  while (begin < end)
  {
    McapPart record;
    record.at = begin;
    record.op = static_cast<unsigned char>(bytes[begin]);
    record.content = bytes.substr(begin + 9, numberAt<std::uint64_t>(bytes, begin + 1));
    begin += record.size();
    records.push_back(record);
  }
  EXPECT_EQ(begin, end) << "records end where the section does";
  return records;
}

std::string textAt(std::string_view bytes, std::size_t& at)
{
  const auto size = numberAt<std::uint32_t>(bytes, at);
  std::string text(bytes.substr(at + 4, size));
  at += 4 + size;
  return text;
}

/** The records in a chunk. */
std::string unpackedChunk(std::string_view content)
{
  const auto size = numberAt<std::uint64_t>(content, 16);
  std::size_t at = 28;
  EXPECT_EQ("zstd", textAt(content, at));
  const auto packed_size = numberAt<std::uint64_t>(content, at);
  at += 8;
  EXPECT_EQ(content.size() - at, packed_size);
  std::string data(size, '\0');
  EXPECT_EQ(size, ZSTD_decompress(data.data(), data.size(), content.data() + at, packed_size));
  EXPECT_EQ(numberAt<std::uint32_t>(content, 24), libdeflate_crc32(0, data.data(), data.size()));
  return data;
}

/** Checks a chunk's message indexes and its entry in the summary. */
void expectIndexed(const std::string& file, const McapPart& index, const McapPart& chunk)
{
  const std::string data = unpackedChunk(chunk.content);
  EXPECT_EQ(chunk.content.substr(0, 16), index.content.substr(0, 16)) << "times of the messages";
  EXPECT_EQ(chunk.at, numberAt<std::uint64_t>(index.content, 16));
  EXPECT_EQ(chunk.size(), numberAt<std::uint64_t>(index.content, 24));
  std::size_t at = 32;
  const std::string offsets = textAt(index.content, at);
  std::size_t indexed = 0;
  std::size_t length = 0;
  for (std::size_t i = 0; i < offsets.size(); i += 10)
  {
    const auto channel = numberAt<std::uint16_t>(offsets, i);
    const auto begin = numberAt<std::uint64_t>(offsets, i + 2);
    const auto of_channel =
        recordsOf(file, begin, begin + 9 + numberAt<std::uint64_t>(file, begin + 1));
    ASSERT_EQ(1U, of_channel.size());
    EXPECT_EQ(7, of_channel[0].op);
    EXPECT_EQ(channel, numberAt<std::uint16_t>(of_channel[0].content, 0));
    length += of_channel[0].size();
    std::size_t entries_at = 2;
    const std::string entries = textAt(of_channel[0].content, entries_at);
    for (std::size_t j = 0; j < entries.size(); j += 16, ++indexed)
    {
      const auto offset = numberAt<std::uint64_t>(entries, j + 8);
      EXPECT_EQ(5, data[offset]) << "a message";
      EXPECT_EQ(channel, numberAt<std::uint16_t>(data, offset + 9));
      EXPECT_EQ(numberAt<std::uint64_t>(entries, j), numberAt<std::uint64_t>(data, offset + 15));
    }
  }
  EXPECT_EQ(length, numberAt<std::uint64_t>(index.content, at)) << "of all message indexes";
  std::size_t messages = 0;
  for (const McapPart& record : recordsOf(data, 0, data.size()))
  {
    messages += record.op == 5 ? 1 : 0;
  }
  EXPECT_EQ(messages, indexed);
}
}  // namespace

TEST(BagWriter, MessagesAreReadBack)
{
  const TestFolder folder;
  const auto clouds = writeSomeBag(folder.file("x.mcap"));
  const auto bag = openBag(folder.file("x.mcap"));
  EXPECT_TRUE(bag->warnings().empty());
  ASSERT_EQ(3U, bag->topics().size()) << "no topic without messages";
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < 3; ++i)
  {
    EXPECT_EQ(RosEncoding::cdr, bag->topics()[i].encoding);
    numbers[bag->topics()[i].name] = i;
  }
  const BagTopic& points = bag->topics()[numbers.at("/points")];
  EXPECT_EQ("sensor_msgs/PointCloud2", points.type);
  EXPECT_EQ(10U, points.messages);
  EXPECT_EQ(1.6e9, points.first);
  EXPECT_EQ(1.6e9 + 4.5, points.last);
  EXPECT_EQ("sensor_msgs/Imu", bag->topics()[numbers.at("/imu")].type);
  EXPECT_TRUE(bag->isInOrder({0, 1, 2}));
  bag->select({0, 1, 2});
  std::vector<std::string> read;
  double last = 0;
  std::size_t messages = 0;
  for (BagMessage message; bag->next(message); ++messages)
  {
    EXPECT_GE(message.recorded, last);
    last = message.recorded;
    if (message.topic == numbers.at("/points"))
    {
      read.emplace_back(message.data);
    }
  }
  EXPECT_EQ(21U, messages);
  EXPECT_TRUE(clouds == read);
}

TEST(BagWriter, TimesOfRecordingDoNotGoBack)
{
  const TestFolder folder;
  {
    BagWriter writer(folder.file("x.mcap"));
    const auto imu = writer.addTopic(writerTopic("/imu", RosType::imu));
    for (const std::uint64_t stamp : {10 * second_ns, 9 * second_ns, 11 * second_ns})
    {
      writer.write(imu, stamp, "data");
    }
    writer.close();
  }
  const auto bag = openBag(folder.file("x.mcap"));
  bag->select({0});
  std::vector<double> times;
  for (BagMessage message; bag->next(message);)
  {
    times.push_back(message.recorded);
  }
  EXPECT_EQ((std::vector<double>{10, 10, 11}), times);
  const std::string file = folder.read("x.mcap");
  const auto records = recordsOf(file, 8, file.size() - 8);
  const auto chunk = std::find_if(records.begin(), records.end(),
                                  [](const McapPart& record) { return record.op == 6; });
  ASSERT_NE(records.end(), chunk);
  const std::string data = unpackedChunk(chunk->content);
  std::vector<std::uint64_t> published;
  for (const McapPart& record : recordsOf(data, 0, data.size()))
  {
    if (record.op == 5)
    {
      EXPECT_EQ(published.size(), numberAt<std::uint32_t>(record.content, 2)) << "sequence";
      published.push_back(numberAt<std::uint64_t>(record.content, 14));
    }
  }
  EXPECT_EQ((std::vector<std::uint64_t>{10 * second_ns, 9 * second_ns, 11 * second_ns}), published);
}

/** Magic, checksums, indexes, statistics and offsets of the summary. */
TEST(BagWriter, TheFileIsAsTheSpecificationSays)
{
  const TestFolder folder;
  writeSomeBag(folder.file("x.mcap"));
  const std::string file = folder.read("x.mcap");
  const std::string magic = "\x89MCAP0\r\n";
  ASSERT_EQ(magic, file.substr(0, 8));
  ASSERT_EQ(magic, file.substr(file.size() - 8));
  const auto records = recordsOf(file, 8, file.size() - 8);
  std::map<int, std::vector<McapPart>> by_kind;
  for (const McapPart& record : records)
  {
    by_kind[record.op].push_back(record);
  }
  ASSERT_EQ(1, records.front().op) << "the header is first";
  std::size_t profile_at = 0;
  EXPECT_EQ("ros2", textAt(records.front().content, profile_at));
  ASSERT_EQ(2, records.back().op) << "the footer is last";
  const std::string_view footer = records.back().content;
  const auto summary = numberAt<std::uint64_t>(footer, 0);
  const auto offsets = numberAt<std::uint64_t>(footer, 8);
  const std::size_t summary_end = records.back().at + 9 + 16;
  EXPECT_EQ(numberAt<std::uint32_t>(footer, 16),
            libdeflate_crc32(0, file.data() + summary, summary_end - summary));
  ASSERT_EQ(1U, by_kind[15].size()) << "one end of the data";
  EXPECT_EQ(summary, by_kind[15][0].at + by_kind[15][0].size());
  EXPECT_EQ(numberAt<std::uint32_t>(by_kind[15][0].content, 0),
            libdeflate_crc32(0, file.data(), by_kind[15][0].at));

  EXPECT_EQ(2U, by_kind[3].size()) << "two types, in the summary";
  EXPECT_EQ(3U, by_kind[4].size());
  EXPECT_GE(by_kind[6].size(), 4U) << "15 MB of noise";
  ASSERT_EQ(by_kind[6].size(), by_kind[8].size());
  for (std::size_t i = 0; i < by_kind[6].size(); ++i)
  {
    expectIndexed(file, by_kind[8][i], by_kind[6][i]);
  }
  ASSERT_EQ(1U, by_kind[11].size());
  const std::string_view statistics = by_kind[11][0].content;
  EXPECT_EQ(21U, numberAt<std::uint64_t>(statistics, 0));
  EXPECT_EQ(2, numberAt<std::uint16_t>(statistics, 8));
  EXPECT_EQ(3U, numberAt<std::uint32_t>(statistics, 10));
  EXPECT_EQ(by_kind[6].size(), numberAt<std::uint32_t>(statistics, 22));
  EXPECT_EQ(bag_begin, numberAt<std::uint64_t>(statistics, 26));
  EXPECT_EQ(bag_begin + 19 * second_ns / 4, numberAt<std::uint64_t>(statistics, 34));

  std::size_t covered = 0;
  for (const McapPart& offset : by_kind[14])
  {
    EXPECT_GE(offset.at, offsets);
    const auto begin = numberAt<std::uint64_t>(offset.content, 1);
    const auto length = numberAt<std::uint64_t>(offset.content, 9);
    for (const McapPart& record : recordsOf(file, begin, begin + length))
    {
      EXPECT_EQ(offset.content[0], record.op);
    }
    covered += length;
  }
  EXPECT_EQ(offsets - summary, covered);
}

TEST(BagWriter, LatchedTopicsAreOfferedToLateSubscribers)
{
  const TestFolder folder;
  writeSomeBag(folder.file("x.mcap"));
  const std::string file = folder.read("x.mcap");
  std::map<std::string, std::string> profiles;
  for (const McapPart& record : recordsOf(file, 8, file.size() - 8))
  {
    if (record.op == 4)
    {
      std::size_t at = 4;
      const std::string name = textAt(record.content, at);
      EXPECT_EQ("cdr", textAt(record.content, at));
      const std::string metadata = textAt(record.content, at);
      std::size_t in_metadata = 0;
      EXPECT_EQ("offered_qos_profiles", textAt(metadata, in_metadata));
      profiles[name] = textAt(metadata, in_metadata);
    }
  }
  EXPECT_TRUE(contains(profiles.at("/map"), "\n  durability: 1\n")) << profiles["/map"];
  EXPECT_TRUE(contains(profiles.at("/points"), "\n  durability: 2\n")) << profiles["/points"];
  EXPECT_EQ(0U, profiles.at("/imu").rfind("- history: 1\n  depth: 10\n  reliability: 1\n", 0));
}

TEST(BagWriter, SameMessagesGiveTheSameBytes)
{
  const TestFolder folder;
  writeSomeBag(folder.file("a.mcap"));
  writeSomeBag(folder.file("b.mcap"));
  EXPECT_TRUE(folder.read("a.mcap") == folder.read("b.mcap"));
}

TEST(BagWriter, DamageIsFoundByTheChecksum)
{
  const TestFolder folder;
  writeSomeBag(folder.file("x.mcap"));
  const std::string intact = folder.read("x.mcap");
  std::string file = intact;
  for (const McapPart& record : recordsOf(intact, 8, intact.size() - 8))
  {
    if (record.op == 6)
    {
      file[record.at + 9 + 24] ^= 1;  // of the checksum itself
    }
  }
  folder.write("x.mcap", file);
  const auto bag = openBag(folder.file("x.mcap"));
  bag->select({0});
  BagMessage message;
  EXPECT_THROW((void)bag->next(message), UserError);
}

TEST(BagWriter, AnUnfinishedFileIsRemovedAndAnEarlierOneStays)
{
  const TestFolder folder;
  folder.write("x.mcap", "earlier");
  {
    BagWriter writer(folder.file("x.mcap"));
    const auto imu = writer.addTopic(writerTopic("/imu", RosType::imu));
    writer.write(imu, second_ns, "data");
    EXPECT_TRUE(std::filesystem::exists(folder.file("x.mcap.tmp")));
  }
  EXPECT_EQ("earlier", folder.read("x.mcap"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.mcap.tmp")));
  const auto message = messageOfError<UserError>([&] { BagWriter(folder.file("no/x.mcap")); });
  EXPECT_TRUE(contains(message, "no/x.mcap: cannot be written: No such file")) << message;
}

TEST(BagWriter, AnEmptyBagIsOne)
{
  const TestFolder folder;
  {
    BagWriter writer(folder.file("x.mcap"));
    (void)writer.addTopic(writerTopic("/imu", RosType::imu));
    writer.close();
  }
  const auto bag = openBag(folder.file("x.mcap"));
  EXPECT_TRUE(bag->topics().empty());
  EXPECT_TRUE(bag->warnings().empty());
}
}  // namespace dyslam
