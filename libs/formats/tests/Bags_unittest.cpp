// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "SomeMessages.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::BagStyle;
using test::TestMessage;

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
}  // namespace dyslam
