// SPDX-License-Identifier: BSD-3-Clause
// Points, rings and intensities in messages of ROS drivers, and damaged messages.
#include <dyslam/base/Error.h>
#include <dyslam/formats/RosMessages.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
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

TEST(RosScans, VelodyneInBothSerialisations)
{
  const Scan scan = sweepOf(50);
  for (const bool cdr : {false, true})
  {
    RosScanDecoder decoder;
    const Scan read = decoded(decoder, test::velodyneFields(scan), cdr);
    expectSame(scan, read, 0);
    EXPECT_TRUE(decoder.warnings().empty());
    ASSERT_EQ(3U, decoder.notes().size());
    EXPECT_EQ("per-point time: field time, seconds from the time stamp", decoder.notes()[1]);
  }
}

TEST(RosScans, OusterCountsRingsFromTheHighest)
{
  const Scan scan = sweepOf(50);
  auto fields = coordinates(scan);
  fields.push_back({"intensity", 7, mapped(scan, [](std::size_t i) { return 100.0 * double(i); })});
  fields.push_back(
      {"t", 6, mapped(scan, [&](std::size_t i) { return std::round(scan.time[i] * 1e9); })});
  fields.push_back(
      {"reflectivity", 4, mapped(scan, [&](std::size_t i) { return scan.intensity[i]; })});
  fields.push_back({"ring", 2, mapped(scan, [&](std::size_t i) { return 3 - scan.ring[i]; })});
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 1e-8);
  EXPECT_TRUE(contains(decoder.notes()[0], "reflectivity"));
  EXPECT_TRUE(contains(decoder.notes()[1], "field t, nanoseconds"));
  EXPECT_TRUE(contains(decoder.notes()[2], "reversed"));
}

TEST(RosScans, IntensitiesAndRingsAsInFiles)
{
  const Scan scan = sweepOf(50);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  auto fields = coordinates(scan);
  fields.push_back(
      {"intensity", 7, mapped(scan, [](std::size_t i) { return i == 1 ? 3000.0 : 51.0; })});
  fields.push_back({"ring", 7,
                    mapped(scan,
                           [](std::size_t i) {
                             return i == 0 ? infinity : i == 1 ? -1.0 : static_cast<double>(i % 4);
                           })});
  RosScanDecoder decoder;
  const Scan read = decoded(decoder, fields);
  EXPECT_EQ(3000, read.intensity.at(1)) << "the converters limit them";
  EXPECT_EQ(0, read.ring.at(0));
  EXPECT_EQ(0, read.ring.at(1));
}

/** Of a lidar with 32 rings, numbered from the highest, the lowest has no return in the first scan,
 * or is not in the cloud at all. */
TEST(RosScans, RingsThatAreMissingInTheFirstScanCount)
{
  constexpr std::uint16_t rings = 32;
  Scan scan;
  scan.stamp = sweep_stamp;
  for (std::uint16_t ring = 1; ring < rings; ++ring)
  {
    scan.points.emplace_back(5, 1, 0.1F * static_cast<float>(ring) - 1);
    scan.ring.push_back(ring);
  }
  const auto decodedRings = [&scan](std::uint16_t last)
  {
    auto fields = coordinates(scan);
    fields.push_back({"ring", 2, mapped(scan, [&](std::size_t i) { return last - scan.ring[i]; })});
    RosScanDecoder decoder;
    return decoded(decoder, fields).ring;
  };
  // 0 to 30 from the highest: ring 31, the lowest, is missing.
  EXPECT_EQ(scan.ring, decodedRings(rings - 1));
  // Twenty rings are no usual number, and none is missing.
  scan.points.resize(20);
  scan.ring.resize(20);
  const std::vector<std::uint16_t> read = decodedRings(20);
  EXPECT_EQ(0, read.front());
  EXPECT_EQ(19, read.back());
}

TEST(RosScans, CoordinatesOfAMapAreTooFarForSinglePrecision)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    fields[axis].type = 8;
  }
  fields[1].values[7] = 1e9;  // marks an invalid point
  RosScanDecoder decoder;
  EXPECT_EQ(decoded(decoder, fields).points[9], scan.points[9]);
  fields[1].values = mapped(scan, [&](std::size_t i) { return 5.4e6 + scan.points[i].y(); });
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)decoded(decoder, fields); }),
                       "more than 100 km from the origin"));
}

TEST(RosScans, NamesOfFieldsInUpperCase)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  const std::vector<std::string> names{"X", "Y", "Z", "Intensity", "Ring", "scalar_Time"};
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    fields[i].name = names[i];
  }
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 0);
  expectSame(scan, decoded(decoder, fields), 0);
  fields.push_back({"x", 7, mapped(scan, [](std::size_t) { return 1.0; })});
  EXPECT_EQ(decoded(decoder, fields).points[7].x(), 1);
}

TEST(RosScans, LivoxMessage)
{
  const Scan scan = sweepOf(50);
  for (const bool cdr : {false, true})
  {
    for (const std::string type : {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg",
                                   "livox_interfaces/CustomMsg"})
    {
      RosScanDecoder decoder;
      const std::string data = test::livoxMessage(cdr, scan);
      expectSame(scan, decoder.decode(topicOf(cdr, type), messageOf(data)), 1e-8);
    }
  }
}

TEST(RosScans, RowsOfAnOrderedCloudAreRings)
{
  Scan scan;
  scan.stamp = sweep_stamp;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 20; ++column)
    {
      scan.points.emplace_back(5, column, 1.F - static_cast<float>(row));
      scan.ring.push_back(static_cast<std::uint16_t>(2 - row));
    }
  }
  RosScanDecoder decoder;
  const Scan read = decoded(decoder, coordinates(scan), true, 3);
  expectSame(scan, read, 0);
  EXPECT_TRUE(decoder.warnings().empty());
  EXPECT_EQ("ring: rows of the cloud, reversed: 0 is the lowest", decoder.notes().back());
}

TEST(RosScans, InvalidPointsKeepTheirPlaces)
{
  Scan scan = sweepOf(50);
  scan.points[3] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  scan.points[4] = Eigen::Vector3f::Zero();
  auto fields = test::velodyneFields(scan);
  fields[5] = {"timestamp", 8,
               mapped(scan, [&](std::size_t i) { return sweep_stamp + scan.time[i]; })};
  fields[5].values[3] = 0;
  RosScanDecoder decoder;
  const Scan read = decoded(decoder, fields);
  ASSERT_EQ(scan.size(), read.size());
  EXPECT_TRUE(std::isnan(read.points[3].x()));
  EXPECT_TRUE(std::isnan(read.time[3]));
  EXPECT_EQ(scan.points[5], read.points[5]);
  EXPECT_NEAR(scan.time[5], read.time[5], 1e-6);
}

/** As drivers publish them before the first revolution. */
TEST(RosScans, AMessageWithoutFieldsIsAnEmptyScan)
{
  const TestFolder folder;
  const Scan scan = sweepOf(50);
  for (const std::string ending : {".bag", ".mcap"})
  {
    const bool cdr = test::holdsCdr("x" + ending);
    const std::string first = test::pointCloud2(cdr, sweep_stamp, {}, 1, "");
    RosScanDecoder decoder;
    const Scan none = decoder.decode(topicOf(cdr, "sensor_msgs/PointCloud2"), messageOf(first));
    EXPECT_EQ(0U, none.size());
    EXPECT_NEAR(sweep_stamp, none.stamp, 1e-6);

    std::vector<test::TestMessage> messages{
        {"/points", "sensor_msgs/PointCloud2", sweep_stamp, first}};
    for (int i = 1; i < 3; ++i)
    {
      const double later = sweep_stamp + 0.1 * i;
      messages.push_back({"/depth", "sensor_msgs/PointCloud2", later,
                          test::pointCloud2(cdr, later, coordinates(scan))});
      messages.push_back({"/points", "sensor_msgs/PointCloud2", later,
                          test::pointCloud2(cdr, later, test::velodyneFields(scan))});
    }
    test::writeBag(folder.file("x" + ending), messages);
    const auto bag = openBag(folder.file("x" + ending));
    const RosScanTopic taken = scanTopics(*bag).front();
    EXPECT_EQ("/points", bag->topics()[taken.topic].name);
    EXPECT_EQ(scan.size(), taken.points);
    EXPECT_EQ("lidar", taken.frame);
    EXPECT_EQ("lidar", frameOfTopic(*bag, taken.topic));
  }
}

TEST(RosScans, ScansInSeveralFramesAreAWarning)
{
  const BagTopic topic = topicOf(true, "sensor_msgs/PointCloud2");
  RosScanDecoder decoder;
  const auto decodeIn = [&](const std::string& frame)
  {
    const auto fields = test::velodyneFields(sweepOf(50));
    (void)decoder.decode(topic, messageOf(test::pointCloud2(true, sweep_stamp, fields, 1, frame)));
    return decoder.warnings();
  };
  EXPECT_TRUE(decodeIn("").empty());
  EXPECT_TRUE(decodeIn("front").empty());
  EXPECT_TRUE(decodeIn("/front").empty());
  EXPECT_TRUE(contains(decodeIn("rear").at(0), "in several frames, 'front' and 'rear'"));
  EXPECT_EQ(decodeIn("left").size(), 1U) << "once";
}

TEST(RosScans, BigEndianPoints)
{
  const Scan scan = sweepOf(50);
  constexpr std::size_t step = 3 + 3 * 4;
  const std::size_t size = scan.size() * step;
  std::string data = test::pointCloud2(false, sweep_stamp, coordinates(scan));
  data.at(data.size() - 1 - size - 4 - 4 - 4 - 1) = 1;
  const auto pointsOf = [&data]
  {
    RosScanDecoder decoder;
    return decoder.decode(topicOf(false, "sensor_msgs/PointCloud2"), messageOf(data)).points;
  };
  EXPECT_EQ(scan.points, pointsOf()) << "little-endian, whatever the message states";
  for (std::size_t at = data.size() - 1 - size; at < data.size() - 1; at += step)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto begin = data.begin() + static_cast<std::ptrdiff_t>(at + 3 + 4 * axis);
      std::reverse(begin, begin + 4);
    }
  }
  EXPECT_EQ(scan.points, pointsOf());
}

TEST(RosScans, RowsWithoutGapsNeedNoLength)
{
  const Scan scan = sweepOf(5);
  std::string rows = test::pointCloud2(false, sweep_stamp, test::velodyneFields(scan), 2);
  const std::size_t row_step = rows.size() - 1 - 4 - 4 - 10 * 2 * (3 + 4 * 5 + 2);
  for (const char length : {'\0', '\x7F'})
  {
    rows.replace(row_step, 4, std::string(4, length));
    RosScanDecoder decoder;
    const Scan read = decoder.decode(topicOf(false, "sensor_msgs/PointCloud2"), messageOf(rows));
    EXPECT_EQ(scan.points, read.points);
  }
}

TEST(RosScans, DamagedMessagesAreRefused)
{
  const Scan scan = sweepOf(5);
  for (const bool cdr : {false, true})
  {
    const std::string cloud = test::pointCloud2(cdr, sweep_stamp, test::velodyneFields(scan));
    const std::string livox = test::livoxMessage(cdr, scan);
    for (const auto& [type, data] :
         {std::pair<std::string, std::string>{"sensor_msgs/PointCloud2", cloud},
          {"livox_ros_driver2/CustomMsg", livox}})
    {
      for (std::size_t size = 0; size + 1 < data.size(); ++size)
      {
        RosScanDecoder decoder;
        const auto message = messageOfError<UserError>(
            [&, &type = type, &data = data]
            { (void)decoder.decode(topicOf(cdr, type), messageOf(data.substr(0, size))); });
        EXPECT_TRUE(contains(message, "x.bag: message at byte 99")) << message;
      }
    }
  }
  // Rows without length would make any number of points fit.
  std::string rows = test::pointCloud2(false, sweep_stamp, test::velodyneFields(scan), 2);
  const std::size_t height = 4 + 8 + 4 + 5;
  rows[height + 3] = '\x7F';
  const std::size_t row_step = rows.size() - 1 - 4 - 4 - 10 * 2 * (3 + 4 * 5 + 2);
  rows.replace(row_step, 4, std::string(4, '\0'));
  RosScanDecoder other;
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)other.decode(topicOf(false, "sensor_msgs/PointCloud2"), messageOf(rows)); }),
      "do not hold"));
  RosScanDecoder decoder;
  auto fields = test::velodyneFields(scan);
  fields[0].name = "east";
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)decoded(decoder, fields); }), "x, y"));
}
}  // namespace dyslam
