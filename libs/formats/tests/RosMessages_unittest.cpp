// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/RosMessages.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SingleMessage.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::messageOf;
using test::topicOf;

constexpr double stamp = 1600000000.25;

/** Four rings of points that get farther and higher with the ring; a tenth of a second. */
Scan sweepOf(std::size_t columns)
{
  Scan scan;
  scan.stamp = stamp;
  for (std::size_t i = 0; i < columns; ++i)
  {
    for (std::uint16_t ring = 0; ring < 4; ++ring)
    {
      const auto angle = static_cast<float>(i) * 0.1F;
      scan.points.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), ring - 1.5F);
      scan.intensity.push_back(static_cast<float>(i % 256));
      scan.time.push_back(0.1F * static_cast<float>(i) / static_cast<float>(columns));
      scan.ring.push_back(ring);
    }
  }
  return scan;
}

std::vector<double> mapped(const Scan& scan, const std::function<double(std::size_t)>& value)
{
  std::vector<double> values;
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    values.push_back(value(i));
  }
  return values;
}

std::vector<test::CloudField> coordinates(const Scan& scan)
{
  std::vector<test::CloudField> fields;
  for (const int axis : {0, 1, 2})
  {
    fields.push_back({std::string(1, "xyz"[axis]), 7,
                      mapped(scan, [&](std::size_t i) { return scan.points[i][axis]; })});
  }
  return fields;
}

Scan decoded(RosScanDecoder& decoder,
             const std::vector<test::CloudField>& fields,
             bool cdr = true,
             std::uint32_t rows = 1)
{
  const std::string data = test::pointCloud2(cdr, stamp, fields, rows);
  return decoder.decode(topicOf(cdr, "sensor_msgs/PointCloud2"), messageOf(data));
}

void expectSame(const Scan& expected, const Scan& scan, double time_tolerance)
{
  EXPECT_NEAR(expected.stamp, scan.stamp, 1e-6);
  EXPECT_EQ(expected.points, scan.points);
  EXPECT_EQ(expected.intensity, scan.intensity);
  EXPECT_EQ(expected.ring, scan.ring);
  ASSERT_EQ(expected.time.size(), scan.time.size());
  for (std::size_t i = 0; i < scan.time.size(); ++i)
  {
    EXPECT_NEAR(expected.time[i], scan.time[i], time_tolerance);
  }
}
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
  scan.stamp = stamp;
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

TEST(RosScans, HesaiAndRoboSenseHaveAbsoluteSeconds)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5] = {"timestamp", 8, mapped(scan, [&](std::size_t i) { return stamp + scan.time[i]; })};
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

TEST(RosScans, TheStampIsTheZeroOfTimesOfTheSameClock)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  RosScanDecoder* decoder = nullptr;
  // Time of the first point from the stamp, for a clock that is behind the header's by `behind`.
  const auto firstTime = [&](double behind)
  {
    fields[5] = {"timestamp", 8,
                 mapped(scan, [&](std::size_t i) { return stamp + scan.time[i] - behind; })};
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
  check(stamp, 0);
  check(5000, 1);
  check(5000.1, 1);
}

TEST(RosScans, DatesHaveTheUnitOfTheirSizeInPartsOfScans)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5] = {"timestamp", 8,
               mapped(scan, [&](std::size_t i) { return (stamp + 0.01 * scan.time[i]) * 1e9; })};
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
      {"timestamp", 8, mapped(scan, [&](std::size_t i) { return (stamp + scan.time[i]) * 1e9; })});
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 2e-6);
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

TEST(RosScans, MicrosecondsAsFloats)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5].values = mapped(scan, [&](std::size_t i) { return 1e6 * scan.time[i]; });
  RosScanDecoder decoder;
  expectSame(scan, decoded(decoder, fields), 1e-7);
}

TEST(RosScans, RowsOfAnOrderedCloudAreRings)
{
  Scan scan;
  scan.stamp = stamp;
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

TEST(RosScans, TimesThatAreNone)
{
  const Scan scan = sweepOf(50);
  auto fields = test::velodyneFields(scan);
  fields[5].values.assign(scan.size(), 0);
  RosScanDecoder zero;
  EXPECT_TRUE(decoded(zero, fields).time.empty());
  EXPECT_TRUE(contains(zero.warnings().at(0), "the same for all points"));
  fields[5].values = mapped(scan, [&](std::size_t i) { return stamp + 128.0 * double(i % 2); });
  RosScanDecoder coarse;
  EXPECT_TRUE(decoded(coarse, fields).time.empty());
  EXPECT_TRUE(contains(coarse.warnings().at(0), "too coarse"));
}

TEST(RosScans, InvalidPointsKeepTheirPlaces)
{
  Scan scan = sweepOf(50);
  scan.points[3] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  scan.points[4] = Eigen::Vector3f::Zero();
  auto fields = test::velodyneFields(scan);
  fields[5] = {"timestamp", 8, mapped(scan, [&](std::size_t i) { return stamp + scan.time[i]; })};
  fields[5].values[3] = 0;
  RosScanDecoder decoder;
  const Scan read = decoded(decoder, fields);
  ASSERT_EQ(scan.size(), read.size());
  EXPECT_TRUE(std::isnan(read.points[3].x()));
  EXPECT_TRUE(std::isnan(read.time[3]));
  EXPECT_EQ(scan.points[5], read.points[5]);
  EXPECT_NEAR(scan.time[5], read.time[5], 1e-6);
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

/** As drivers publish them before the first revolution. */
TEST(RosScans, AMessageWithoutFieldsIsAnEmptyScan)
{
  const TestFolder folder;
  const Scan scan = sweepOf(50);
  for (const std::string ending : {".bag", ".mcap"})
  {
    const bool cdr = test::holdsCdr("x" + ending);
    const std::string first = test::pointCloud2(cdr, stamp, {}, 1, "");
    RosScanDecoder decoder;
    const Scan none = decoder.decode(topicOf(cdr, "sensor_msgs/PointCloud2"), messageOf(first));
    EXPECT_EQ(0U, none.size());
    EXPECT_NEAR(stamp, none.stamp, 1e-6);

    std::vector<test::TestMessage> messages{{"/points", "sensor_msgs/PointCloud2", stamp, first}};
    for (int i = 1; i < 3; ++i)
    {
      const double later = stamp + 0.1 * i;
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

TEST(RosScans, BigEndianPoints)
{
  const Scan scan = sweepOf(50);
  constexpr std::size_t step = 3 + 3 * 4;
  const std::size_t size = scan.size() * step;
  std::string data = test::pointCloud2(false, stamp, coordinates(scan));
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
  std::string rows = test::pointCloud2(false, stamp, test::velodyneFields(scan), 2);
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
    const std::string cloud = test::pointCloud2(cdr, stamp, test::velodyneFields(scan));
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
  std::string rows = test::pointCloud2(false, stamp, test::velodyneFields(scan), 2);
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

TEST(RosPoses, StaticTransformsOfANamespace)
{
  const TestFolder folder;
  const auto childrenOf = [&folder](const std::vector<std::string>& topics)
  {
    std::vector<test::TestMessage> messages;
    for (const std::string& topic : topics)
    {
      messages.push_back({topic, "tf2_msgs/TFMessage", stamp,
                          test::transforms(true, stamp, {{"of " + topic, Pose::Identity()}})});
    }
    test::writeBag(folder.file("x.mcap"), messages);
    const auto bag = openBag(folder.file("x.mcap"));
    std::vector<std::string> children;
    for (const auto& [child, transform] : staticTransforms(*bag))
    {
      children.push_back(child);
    }
    return children;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(childrenOf({"/robot/tf_static"}), Names{"of /robot/tf_static"});
  EXPECT_EQ(childrenOf({"/robot/tf_static", "/tf_static"}), Names{"of /tf_static"});
  EXPECT_EQ(childrenOf({"tf_static"}), Names{"of tf_static"});
  EXPECT_EQ(childrenOf({"/a/tf_static", "/b/tf_static"}), Names());
  EXPECT_EQ(childrenOf({"/my_tf_static"}), Names());
}

TEST(RosPoses, EveryTypeInBothSerialisations)
{
  const Pose pose = poseFromYpr(1, 2, 3, 0.5, -0.2, 0.1);
  for (const bool cdr : {false, true})
  {
    const auto check = [&](const std::string& type, const std::string& data, const char* child)
    {
      ASSERT_TRUE(isRosPose(topicOf(cdr, type)));
      const auto poses = decodeRosPoses(topicOf(cdr, type), messageOf(data));
      ASSERT_FALSE(poses.empty());
      EXPECT_NEAR(stamp, poses.back().stamp, 1e-6);
      EXPECT_EQ(child, poses.back().child);
      EXPECT_TRUE(poses.back().pose.isApprox(pose, 1e-12));
    };
    check("geometry_msgs/PoseStamped", test::poseStamped(cdr, stamp, pose), "");
    check("nav_msgs/Odometry", test::odometry(cdr, stamp, pose), "base_link");
    const std::string tf =
        test::transforms(cdr, stamp, {{"other", Pose::Identity()}, {"base_link", pose}});
    check("tf2_msgs/TFMessage", tf, "base_link");
    check("tf/tfMessage", tf, "base_link");
    EXPECT_EQ(2U, decodeRosPoses(topicOf(cdr, "tf2_msgs/TFMessage"), messageOf(tf)).size());
    EXPECT_FALSE(isRosPose(topicOf(cdr, "sensor_msgs/Imu")));

    const std::string data = test::odometry(cdr, stamp, pose);
    const auto message = messageOfError<UserError>(
        [&] {
          (void)decodeRosPoses(topicOf(cdr, "nav_msgs/Odometry"), messageOf(data.substr(0, 60)));
        });
    EXPECT_TRUE(contains(message, "short")) << message;
  }
  std::string zero = test::poseStamped(false, stamp, pose);
  std::fill(zero.end() - 32, zero.end(), '\0');
  std::size_t left_out = 0;
  const BagTopic topic = topicOf(false, "geometry_msgs/PoseStamped");
  EXPECT_TRUE(decodeRosPoses(topic, messageOf(zero), &left_out).empty());
  EXPECT_EQ(left_out, 1U);
}
}  // namespace dyslam
