// SPDX-License-Identifier: BSD-3-Clause
// Times of the points and stamps of the scans in messages of ROS drivers.
#include <dyslam/formats/RosMessages.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SingleMessage.h"
#include "SomeRosScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::coordinates;
using test::decoded;
using test::expectSame;
using test::mapped;
using test::messageOf;
using test::sweep_stamp;
using test::sweepOf;
using test::topicOf;
}  // namespace

TEST(RosScans, HesaiAndRoboSenseHaveAbsoluteSeconds)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5] = {"timestamp", 8,
               mapped(scan, [&](std::size_t i) { return sweep_stamp + scan.time[i]; })};
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 1e-6);
  // The lidar's clock is that of its start-up: the first point gets the header's time.
  fields[5].values = mapped(scan, [&](std::size_t i) { return 5000.0 + scan.time[i]; });
  RosScanDecoder other;
  expectSame(scan, decoded(other, fields), 1e-6);
  ASSERT_EQ(1U, other.warnings().size());
  EXPECT_TRUE(contains(other.warnings()[0], "clock"));
  // Soon after its start-up, too.
  RosScanDecoder early;
  for (const double first : {3.0, 3.5})
  {
    fields[5].values = mapped(scan, [&](std::size_t i) { return first + scan.time[i]; });
    expectSame(scan, decoded(early, fields), 1e-6);
  }
}

TEST(RosScans, TheStampIsTheZeroOfTimesOfTheSameClock)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  RosScanDecoder* decoder = nullptr;
  // Time of the first point from the stamp, for a clock that is behind the header's by
  // `behind`.
  const auto firstTime = [&](double behind)
  {
    fields[5] = {"timestamp", 8,
                 mapped(scan, [&](std::size_t i) { return sweep_stamp + scan.time[i] - behind; })};
    return decoded(*decoder, fields).time.at(0);
  };
  for (const double behind : {0.0, 0.05, 0.1, 0.15, -0.05})  // to a stamp behind the last point
  {
    RosScanDecoder one;
    decoder = &one;
    EXPECT_NEAR(-behind, firstTime(behind), 1e-6) << behind;
    EXPECT_TRUE(one.warnings().empty()) << behind;
    EXPECT_NEAR(-0.6, firstTime(0.6), 1e-6) << behind;  // a drift does not move the zero
    EXPECT_TRUE(one.warnings().empty()) << behind;
  }
  for (const double behind : {0.3, 0.6, 37.0, -0.2})
  {
    RosScanDecoder one;
    decoder = &one;
    EXPECT_NEAR(0, firstTime(behind), 1e-6) << behind;
    EXPECT_NEAR(0, firstTime(0.05), 1e-6) << behind;
    ASSERT_EQ(1U, one.warnings().size()) << behind;
    EXPECT_TRUE(contains(one.warnings()[0], "clock"));
  }
}

/** A lidar that loses its time source. */
TEST(RosScans, AClockThatIsSetIsNoLongerThatOfTheHeaders)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  RosScanDecoder decoder;
  const auto check = [&](double zero, std::size_t warnings)
  {
    fields[5] = {"timestamp", 8, mapped(scan, [&](std::size_t i) { return zero + scan.time[i]; })};
    expectSame(scan, decoded(decoder, fields), 1e-6);
    EXPECT_EQ(warnings, decoder.warnings().size());
  };
  check(sweep_stamp, 0);
  check(5000, 1);
  check(5000.1, 1);
}

TEST(RosScans, DatesHaveTheUnitOfTheirSizeInPartsOfScans)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5] = {
      "timestamp", 8,
      mapped(scan, [&](std::size_t i) { return (sweep_stamp + 0.01 * scan.time[i]) * 1e9; })};
  RosScanDecoder decoder;
  const Scan part = decoded(decoder, fields);
  EXPECT_NEAR(0.01 * scan.time.back(), part.time.back(), 1e-6);
  EXPECT_TRUE(contains(decoder.notes().at(1), "nanoseconds from the clock's zero"));
  EXPECT_TRUE(decoder.warnings().empty());
}

TEST(RosScans, LivoxCloudHasAbsoluteNanosecondsAndLines)
{
  Scan scan = sweepOf(50);
  auto fields = coordinates(scan);
  fields.push_back(
      {"intensity", 7, mapped(scan, [&](std::size_t i) { return scan.intensity[i]; })});
  // Lines cross each other: their numbers do not tell heights.
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    scan.ring[i] = static_cast<std::uint16_t>(i / 4 % 6);
  }
  fields.push_back({"line", 2, mapped(scan, [&](std::size_t i) { return scan.ring[i]; })});
  fields.push_back(
      {"timestamp", 8,
       mapped(scan, [&](std::size_t i) { return (sweep_stamp + scan.time[i]) * 1e9; })});
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 2e-6);
}

TEST(RosScans, MicrosecondsAsFloats)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5].values = mapped(scan, [&](std::size_t i) { return 1e6 * scan.time[i]; });
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 1e-7);
}

TEST(RosScans, TimesThatAreNone)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5].values.assign(scan.size(), 0);
  RosScanDecoder zero;
  EXPECT_TRUE(decoded(zero, fields).time.empty());
  EXPECT_TRUE(contains(zero.warnings().at(0), "the same for all points"));
  fields[5].values =
      mapped(scan, [&](std::size_t i) { return sweep_stamp + 128.0 * double(i % 2); });
  RosScanDecoder coarse;
  EXPECT_TRUE(decoded(coarse, fields).time.empty());
  EXPECT_TRUE(contains(coarse.warnings().at(0), "too coarse"));
}

TEST(RosScans, ABlankMessageSaysNothingAboutTheStamps)
{
  const Scan scan = sweepOf(50);
  const BagTopic topic = topicOf(false, "sensor_msgs/PointCloud2");
  RosScanDecoder decoder;
  const std::string blank = test::pointCloud2(false, 0, test::velodyneFields(Scan()));
  const Scan none = decoder.decode(topic, messageOf(blank));
  EXPECT_EQ(0U, none.size());
  EXPECT_EQ(0, none.stamp);
  expectSame(scan, decoded(decoder, test::velodyneFields(scan)), 0);
  EXPECT_TRUE(decoder.warnings().empty());

  RosScanDecoder without;
  const std::string data = test::pointCloud2(false, 0, test::velodyneFields(scan));
  EXPECT_EQ(12, without.decode(topic, messageOf(data)).stamp);  // when it was recorded
  EXPECT_EQ(1U, without.warnings().size());
}

/** A simulator's clock begins at zero, whatever that of the recorder is. */
TEST(RosScans, AStampOfZeroIsOneOfASimulator)
{
  const TestFolder folder;
  const auto isOfSimulator = [&](double first, double period)
  {
    std::vector<test::TestMessage> messages;
    for (int i = 0; i < 3; ++i)
    {
      messages.push_back(
          {"/points", "sensor_msgs/PointCloud2", sweep_stamp + 0.1 * i,
           test::pointCloud2(true, first + period * i, test::velodyneFields(sweepOf(50)))});
    }
    test::writeBag(folder.file("x.mcap"), messages);
    return clockBeginsAtZero(*openBag(folder.file("x.mcap")), 0);
  };
  EXPECT_TRUE(isOfSimulator(0, 0.1));
  EXPECT_FALSE(isOfSimulator(0, 0)) << "headers without stamps";
  EXPECT_FALSE(isOfSimulator(sweep_stamp, 0.1));
  EXPECT_FALSE(isOfSimulator(0, sweep_stamp)) << "the first one only was not set";

  RosScanDecoder decoder(true);
  const std::string data = test::pointCloud2(true, 0, test::velodyneFields(sweepOf(50)));
  const BagTopic topic = topicOf(true, "sensor_msgs/PointCloud2");
  EXPECT_EQ(0, decoder.decode(topic, messageOf(data)).stamp);
  EXPECT_TRUE(decoder.warnings().empty());
}

/** The clock of the points is that of the recorder. */
TEST(RosScans, AbsoluteTimesWithoutAStampOfTheHeader)
{
  const Scan scan = sweepOf(50);
  constexpr double recorded = 12;  // see messageOf()
  auto fields = coordinates(scan);
  fields.push_back({"timestamp", 8,
                    mapped(scan, [&](std::size_t i) { return recorded - 0.15 + scan.time[i]; })});
  const std::string data = test::pointCloud2(true, 0, fields);
  RosScanDecoder decoder;
  const Scan read = decoder.decode(topicOf(true, "sensor_msgs/PointCloud2"), messageOf(data));
  EXPECT_EQ(recorded, read.stamp);
  ASSERT_EQ(scan.size(), read.time.size());
  EXPECT_NEAR(scan.time.back() - 0.15F, read.time.back(), 1e-6);
  ASSERT_EQ(1U, decoder.warnings().size());
  EXPECT_TRUE(contains(decoder.warnings()[0], "its headers have no time stamp"));
}
}  // namespace dyslam
