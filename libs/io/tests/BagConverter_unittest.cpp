// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SyntheticHesai.h"
#include "SyntheticOuster.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr std::size_t scan_count = 7;

Scan scanWithTimes(std::size_t number)
{
  Scan scan = someScan(number, 40 + number);
  scan.T_vehicle_lidar = poseFromYpr(1, 0.5, 1.75, 0, 0, 0);
  scan.stamp = 1600000000 + 0.125 * static_cast<double>(number);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    scan.time.push_back(1e-3F * static_cast<float>(i));
    scan.ring.push_back(static_cast<std::uint16_t>(i % 16));
  }
  return scan;
}

/** The scans with their truth as /odom and /tf, another sparse lidar, and something else. */
std::vector<test::TestMessage> messagesOf(bool cdr)
{
  std::vector<test::TestMessage> messages;
  for (std::size_t i = 0; i < scan_count; ++i)
  {
    const Scan scan = scanWithTimes(i);
    const double recorded = scan.stamp + 0.01;
    messages.push_back(
        {"/odom", "nav_msgs/Odometry", recorded, test::odometry(cdr, scan.stamp, somePose(i))});
    messages.push_back(
        {"/tf", "tf2_msgs/TFMessage", recorded,
         test::transforms(cdr, scan.stamp, {{"base", somePose(i)}, {"wheel", Pose::Identity()}})});
    messages.push_back({"/points", "sensor_msgs/PointCloud2", recorded,
                        test::pointCloud2(cdr, scan.stamp, test::velodyneFields(scan))});
    if (i % 2 == 0)
    {
      messages.push_back({"/rear", "sensor_msgs/PointCloud2", recorded,
                          test::pointCloud2(cdr, scan.stamp, test::velodyneFields(scan))});
    }
  }
  return messages;
}

void write(const std::string& path)
{
  test::writeBag(path, messagesOf(test::holdsCdr(path)));
}
}  // namespace

TEST(BagConverter, TheSameRecordingGivesTheSameBytesWhateverItCameIn)
{
  const TestFolder folder;
  {
    RawlogWriter original(folder.file("original.rawlog"));
    for (std::size_t i = 0; i < scan_count; ++i)
    {
      original.write(scanWithTimes(i));
    }
    original.close();
  }
  const std::string bytes = folder.read("original.rawlog");
  ScanConverterOptions options;
  options.sensor = "velodyne";
  options.sensor_pose = "1 0.5 1.75 0 0 0";
  options.topic = "/points";
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    write(folder.file("x" + ending));
    const auto result = convertScans(folder.file("x" + ending), folder.file("x.rawlog"), options);
    EXPECT_EQ(scan_count, result.scans);
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_EQ(bytes, folder.read("x.rawlog")) << ending;
  }
  for (const std::string compression : {"bz2", "lz4"})
  {
    test::writeRos1Bag(folder.file("x.bag"), messagesOf(false), {compression});
    (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
    EXPECT_EQ(bytes, folder.read("x.rawlog")) << compression;
  }
  for (const std::string compression : {"lz4", "zstd"})
  {
    test::writeMcap(folder.file("x.mcap"), messagesOf(true), {compression});
    (void)convertScans(folder.file("x.mcap"), folder.file("x.rawlog"), options);
    EXPECT_EQ(bytes, folder.read("x.rawlog")) << compression;
  }
}

TEST(BagConverter, BagsOfAFolderWithoutMetadataAreNamed)
{
  const TestFolder folder;
  std::filesystem::create_directories(folder.file("day"));
  write(folder.file("day/a_0.mcap"));
  write(folder.file("day/a_1.mcap"));
  const auto isNamed = [&folder]
  {
    const auto result = convertScans(folder.file("day"), folder.file("x.rawlog"), {});
    return std::count(result.notes.begin(), result.notes.end(),
                      folder.file("day") +
                          ": its 2 bags are taken as the parts of one recording, "
                          "from a_0.mcap to a_1.mcap") == 1;
  };
  EXPECT_TRUE(isNamed());
  folder.write("day/metadata.yaml", "");
  EXPECT_FALSE(isNamed());
}

TEST(BagConverter, TruthOfATopic)
{
  const TestFolder folder;
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    write(folder.file("x" + ending));
    ScanConverterOptions options;
    options.sensor_pose = "1,0.5,1.75,90,0,0";
    for (const std::string topic : {"/odom", "/tf"})
    {
      options.truth_topic = topic;
      options.truth_frame = topic == "/tf" ? "base" : "";
      const auto result = convertScans(folder.file("x" + ending), folder.file("x.rawlog"), options);
      EXPECT_EQ(scan_count, result.poses);
      const auto frames = readAll(folder.file("x.rawlog"));
      ASSERT_EQ(scan_count, frames.size());
      for (std::size_t i = 0; i < scan_count; ++i)
      {
        ASSERT_TRUE(frames[i].T_world_vehicle_truth);
        EXPECT_TRUE(frames[i].T_world_vehicle_truth->isApprox(somePose(i), 1e-9));
        EXPECT_NEAR(M_PI / 2, yawPitchRoll(frames[i].scan.T_vehicle_lidar)[0], 1e-9);
      }
      EXPECT_EQ(scan_count, readTum(folder.file("x.gt/poses_tum.txt")).size());
    }
  }
}

TEST(BagConverter, PosesAreInterpolatedAndMissingOnesCounted)
{
  const TestFolder folder;
  std::vector<test::TestMessage> messages;
  for (std::size_t i = 0; i < scan_count; ++i)
  {
    const Scan scan = scanWithTimes(i);
    messages.push_back({"/points", "sensor_msgs/PointCloud2", scan.stamp,
                        test::pointCloud2(false, scan.stamp, test::velodyneFields(scan))});
    if (i < 3)
    {
      const double between = scan.stamp + 0.0625;
      messages.push_back(
          {"/pose", "geometry_msgs/PoseStamped", between,
           test::poseStamped(false, between, poseFromYpr(2.0 * double(i), 0, 0, 0, 0, 0))});
    }
  }
  test::writeBag(folder.file("x.bag"), messages);
  ScanConverterOptions options;
  options.truth_topic = "/pose";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_EQ(2U, result.poses);  // those between two poses
  EXPECT_EQ(PoseSource::given, poseOrigin(folder.file("x.gt")).source);
  EXPECT_EQ("/pose", poseOrigin(folder.file("x.gt")).name);
  EXPECT_TRUE(contains(result.warnings.at(0), "no pose within 0.2 s of 5 scans"));
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(3, frames.at(2).T_world_vehicle_truth->translation().x(), 1e-5);
}

TEST(BagConverter, ChoosesTheTopicThatLooksMostLikeTheLidars)
{
  const TestFolder folder;
  write(folder.file("x.bag"));
  ScanConverterOptions options;
  const auto all = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_EQ(scan_count, all.scans);
  ASSERT_FALSE(all.notes.empty());
  EXPECT_EQ("scans: /points (sensor_msgs/PointCloud2)", all.notes[0]);
  ASSERT_FALSE(all.warnings.empty());
  EXPECT_TRUE(contains(all.warnings[0], "--topic chooses others: /rear")) << all.warnings[0];
  options.topic = "/rear";
  EXPECT_EQ(4U, convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options).scans);
  options.skip_first_n = 1;
  options.only_first_n = 2;
  EXPECT_EQ(2U, convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options).scans);
}

TEST(BagConverter, CloudsInTheFrameOfAMapAreAWarning)
{
  const TestFolder folder;
  const auto isWarning = [&folder](const std::string& frame)
  {
    const Scan scan = scanWithTimes(0);
    const std::string path = folder.file("x.bag");
    test::writeRos1Bag(
        path, {{"/cloud_registered", "sensor_msgs/PointCloud2", scan.stamp,
                test::pointCloud2(false, scan.stamp, test::velodyneFields(scan), 1, frame)}});
    const auto warnings = convertScans(path, folder.file("x.rawlog"), {}).warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& warning)
                       { return contains(warning, "/cloud_registered is in the frame 'odom'"); });
  };
  EXPECT_TRUE(isWarning("/odom"));
  EXPECT_FALSE(isWarning("velodyne"));
}

/** As from a driver that writes the share of the revolution in place of seconds. */
TEST(BagConverter, PointTimesOverMoreThanTheIntervalAreAWarning)
{
  const TestFolder folder;
  const auto warningWith = [&](float factor, std::size_t scans)
  {
    std::vector<test::TestMessage> messages;
    for (std::size_t i = 0; i < scans; ++i)
    {
      Scan scan = scanWithTimes(i);  // over 0.04 s, every 0.125 s
      for (float& time : scan.time)
      {
        time *= factor;
      }
      messages.push_back({"/points", "sensor_msgs/PointCloud2", scan.stamp,
                          test::pointCloud2(true, scan.stamp, test::velodyneFields(scan))});
    }
    test::writeBag(folder.file("x.mcap"), messages);
    std::string found;
    for (const std::string& line :
         convertScans(folder.file("x.mcap"), folder.file("x.rawlog"), {}).warnings)
    {
      found += contains(line, "the points of a scan have times over") ? line : "";
    }
    return found;
  };
  EXPECT_TRUE(contains(warningWith(10, 13), "s, but scans are 0.125 s apart"));
  EXPECT_EQ(warningWith(2, 13), "");
  EXPECT_EQ(warningWith(10, 5), "") << "too few to tell";
}

TEST(BagConverter, BrightIntensitiesAreLimitedAsInFiles)
{
  const TestFolder folder;
  Scan scan = scanWithTimes(0);
  scan.intensity.assign(scan.size(), 51);
  scan.intensity.back() = 3000;
  test::writeBag(folder.file("x.bag"),
                 {{"/points", "sensor_msgs/PointCloud2", scan.stamp,
                   test::pointCloud2(false, scan.stamp, test::velodyneFields(scan))}});
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), {});
  EXPECT_EQ(1, std::count(result.notes.begin(), result.notes.end(),
                          "intensity: field intensity, limited to 255"));
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(0.2F, frames.at(0).scan.intensity.at(0), 1e-6);
  EXPECT_EQ(1, frames[0].scan.intensity.back());
}

TEST(BagConverter, Errors)
{
  const TestFolder folder;
  write(folder.file("x.bag"));
  ScanConverterOptions options;
  const auto message = [&](const std::string& name)
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(folder.file(name), folder.file("x.rawlog"), options); });
  };
  options.topic = "/nothing";
  EXPECT_TRUE(contains(message("x.bag"), "/nothing is not in it; use /points, /rear"));
  options.topic = "/odom";
  EXPECT_TRUE(contains(message("x.bag"), "nav_msgs/Odometry is not read; use /points, /rear"));
  options.topic = "";
  options.truth_topic = "/tf";
  EXPECT_TRUE(contains(message("x.bag"), "poses of base, wheel; choose one with --truth-frame"));
  options.truth_frame = "nobody";
  EXPECT_TRUE(contains(message("x.bag"), "no poses of --truth-frame nobody"));
  options.truth_topic = "";
  EXPECT_TRUE(contains(message("x.bag"), "--truth-topic"));
  options = {};
  options.sensor_pose = "1 2 3";
  EXPECT_TRUE(contains(message("x.bag"), "six numbers"));
  options = {};
  options.poses = "p.txt";
  EXPECT_TRUE(contains(message("x.bag"), "--poses works with a folder of scans only"));
  options = {};
  options.skip_first_n = 100;
  EXPECT_TRUE(contains(message("x.bag"), "--skip-first-n leaves none"));
  options = {};
  test::writeRos1Bag(folder.file("y.bag"), {{"/packets", "hesai_ros/PacketMsg", 1, "x"}});
  EXPECT_TRUE(contains(message("y.bag"), "packets (/packets)"));
  test::writeRos1Bag(folder.file("y.bag"), {{"/packets", "velodyne_msgs/VelodyneScan", 1, "x"}});
  EXPECT_TRUE(contains(message("y.bag"), "y.bag: message at byte"));
  const std::string compressed = "point_cloud_interfaces/CompressedPointCloud2";
  test::writeRos1Bag(folder.file("y.bag"), {{"/points/draco", compressed, 1, "x"}});
  EXPECT_TRUE(contains(message("y.bag"), "compressed clouds (/points/draco)"));
  test::writeRos1Bag(folder.file("y.bag"), {{"/scan", "sensor_msgs/LaserScan", 1, "x"}});
  EXPECT_TRUE(contains(message("y.bag"), "2D scans (/scan), which are not read"));
  test::writeRos1Bag(folder.file("y.bag"), {{"/text", "std_msgs/String", 1, "x"}});
  EXPECT_TRUE(contains(message("y.bag"), "--list"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog.tmp")));
}

namespace
{
/** Velodyne's packets as its driver collects them: those of a turn in one message. */
std::vector<test::TestMessage> velodyneMessages(bool cdr)
{
  constexpr double packet_time = 12 * 2 * 55.296e-6;
  constexpr std::size_t packets_in_message = 76;
  std::vector<test::TestMessage> messages;
  for (std::size_t n = 0; n < 5; ++n)
  {
    std::vector<std::pair<double, std::string>> packets;
    for (std::size_t i = n * packets_in_message; i < (n + 1) * packets_in_message; ++i)
    {
      const double time = static_cast<double>(i) * packet_time;
      packets.emplace_back(1000 + time, velodynePacket(time));
    }
    const double stamp = packets.back().first;
    messages.push_back({"/velodyne_packets", "velodyne_msgs/VelodyneScan", stamp,
                        test::velodyneScan(cdr, stamp, packets)});
  }
  return messages;
}

/** Packets of an Ouster and of its IMU, and two kinds of metadata. */
std::vector<test::TestMessage> ousterMessages(bool cdr)
{
  const SyntheticOuster lidar;
  SyntheticOuster other;
  other.profile = "LEGACY";
  std::vector<test::TestMessage> messages{
      {"/rear/metadata", "std_msgs/String", 999, test::stringMessage(cdr, other.metadata())},
      {"/front/metadata", "std_msgs/String", 999, test::stringMessage(cdr, lidar.metadata())}};
  double time = 1000;
  std::uint64_t imu_time = lidar.first_time + 10000000;  // [ns]
  for (const std::string& packet : lidar.packetsOf(4))
  {
    messages.push_back({"/front/lidar_packets", "ouster_sensor_msgs/PacketMsg", time,
                        test::ousterPacketMessage(cdr, packet)});
    messages.push_back({"/front/imu_packets", "ouster_sensor_msgs/PacketMsg", time,
                        test::ousterPacketMessage(cdr, SyntheticOuster::imuPacket(imu_time))});
    imu_time += 25000000;
    time += SyntheticOuster::turn / SyntheticOuster::packets;
  }
  return messages;
}

struct Converted
{
  ConversionResult result;
  std::vector<Frame> frames;
};

Converted convertedBag(const TestFolder& folder,
                       const std::string& bag,
                       const ScanConverterOptions& options = {})
{
  Converted converted;
  converted.result = convertScans(bag, folder.file("x.rawlog"), options);
  RawlogSource source(folder.file("x.rawlog"));
  while (auto frame = source.next())
  {
    converted.frames.push_back(std::move(*frame));
  }
  return converted;
}

bool hasNote(const Converted& converted, const std::string& text)
{
  const auto& notes = converted.result.notes;
  return std::any_of(notes.begin(), notes.end(),
                     [&text](const std::string& note) { return contains(note, text); });
}
}  // namespace

TEST(BagConverter, VelodynePackets)
{
  for (const char* name : {"a.bag", "a.mcap"})
  {
    const TestFolder folder;
    const std::string bag = folder.file(name);
    test::writeBag(bag, velodyneMessages(test::holdsCdr(bag)));
    const Converted converted = convertedBag(folder, bag);
    EXPECT_TRUE(hasNote(converted, "packets of a VLP16")) << name;
    // 5.04 turns from straight ahead, cut behind: four whole ones.
    ASSERT_EQ(4U, converted.frames.size()) << name;
    for (const Frame& frame : converted.frames)
    {
      EXPECT_NEAR(10, frame.scan.points.at(0).norm(), 1e-3);
      EXPECT_EQ(frame.scan.size(), frame.scan.ring.size());
      EXPECT_EQ(frame.scan.size(), frame.scan.time.size());
    }
    EXPECT_NEAR(1000.05, converted.frames[0].scan.stamp, 0.002);
    EXPECT_NEAR(0.1, converted.frames[1].scan.stamp - converted.frames[0].scan.stamp, 0.002);
    ScanConverterOptions options;
    options.keep_partial = true;
    EXPECT_EQ(6U, convertedBag(folder, bag, options).frames.size()) << name;
  }
}

TEST(BagConverter, HesaiPackets)
{
  using test::HesaiMessage;
  const std::vector<std::pair<std::string, HesaiMessage>> kinds{
      {"pandar_msgs/PandarScan", HesaiMessage::pandar_scan},
      {"hesai_ros_driver/UdpFrame", HesaiMessage::udp_frame},
      {"nebula_msgs/NebulaPackets", HesaiMessage::nebula_packets}};
  const SyntheticHesai lidar;
  constexpr std::size_t packets_in_message = 250;
  for (const bool cdr : {false, true})
  {
    for (const auto& [type, kind] : kinds)
    {
      std::vector<test::TestMessage> messages;
      for (std::size_t n = 0; n < 4; ++n)
      {
        std::vector<std::pair<double, std::string>> packets;
        for (std::size_t i = n * packets_in_message; i < (n + 1) * packets_in_message; ++i)
        {
          packets.emplace_back(1000 + static_cast<double>(i) * lidar.packetTime(), lidar.packet(i));
        }
        const double stamp = packets.back().first;
        messages.push_back(
            {"/lidar_packets", type, stamp, test::hesaiMessage(cdr, stamp, packets, kind)});
      }
      const TestFolder folder;
      const std::string bag = folder.file(cdr ? "a.db3" : "a.bag");
      test::writeBag(bag, messages);
      const Converted converted = convertedBag(folder, bag);
      ASSERT_EQ(3U, converted.frames.size()) << type;
      EXPECT_TRUE(hasNote(converted, "packets of a XT32"));
      EXPECT_NEAR(1000.05, converted.frames[0].scan.stamp, 0.002);
      EXPECT_NEAR(12, converted.frames[0].scan.points[0].norm(), 1e-3);
    }
  }
}

TEST(BagConverter, HesaiPacketsThatAreNotDecodedAreNamed)
{
  std::string packet = SyntheticHesai().packet(0);
  packet.replace(2, 2, "\x04\x03");
  const TestFolder folder;
  const std::string bag = folder.file("a.db3");
  test::writeBag(
      bag, {{"/lidar_packets", "pandar_msgs/PandarScan", 1000,
             test::hesaiMessage(true, 1000, {{1000, packet}}, test::HesaiMessage::pandar_scan)}});
  const std::string message = messageOfError<UserError>([&] { (void)convertedBag(folder, bag); });
  EXPECT_TRUE(contains(message, "left out 1 packet of a Hesai AT128, which are not decoded"))
      << message;
}

TEST(BagConverter, OusterPackets)
{
  for (const char* name : {"a.bag", "a.db3"})
  {
    const TestFolder folder;
    const std::string bag = folder.file(name);
    const auto messages = ousterMessages(test::holdsCdr(bag));
    test::writeBag(bag, messages);
    const Converted converted = convertedBag(folder, bag);
    EXPECT_TRUE(hasNote(converted, "scans: /front/lidar_packets")) << name;
    EXPECT_TRUE(hasNote(converted, "metadata of the lidar: /front/metadata")) << name;
    EXPECT_TRUE(converted.result.warnings.empty()) << converted.result.warnings.front();
    ASSERT_EQ(4U, converted.frames.size()) << name;
    EXPECT_EQ(240U, converted.frames[0].scan.size());
    EXPECT_NEAR(1000.1, converted.frames[1].scan.stamp, 1e-6);
    EXPECT_TRUE(contains(listingOf(*openBag(bag)), "packets  os_sensor  <- taken without --topic"));

    test::writeBag(bag, {messages.begin() + 2, messages.end()});
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convertedBag(folder, bag); }),
                         "has no metadata of this Ouster lidar"));
    ScanConverterOptions options;
    options.calibration = folder.write("m.json", SyntheticOuster().metadata(true));
    EXPECT_EQ(4U, convertedBag(folder, bag, options).frames.size()) << name;
  }
}

TEST(BagConverter, TheImuInAnOuster)
{
  for (const char* name : {"a.bag", "a.mcap"})
  {
    const TestFolder folder;
    const std::string bag = folder.file(name);
    auto messages = ousterMessages(test::holdsCdr(bag));
    test::writeBag(bag, messages);
    EXPECT_TRUE(contains(listingOf(*openBag(bag)), "<- for --imu-topic"));
    EXPECT_TRUE(hasNote(convertedBag(folder, bag), "--imu-topic /front/imu_packets adds"));
    ScanConverterOptions options;
    options.imu_topic = "/front/imu_packets";
    const Converted converted = convertedBag(folder, bag, options);
    EXPECT_TRUE(converted.result.warnings.empty());
    EXPECT_TRUE(hasNote(converted, "12 samples; mounted as the metadata of the lidar state"));
    ASSERT_EQ(4U, converted.frames.size()) << name;
    EXPECT_EQ(4U, converted.frames[1].imu.size());
    const ImuSample& sample = converted.frames[1].imu.front();
    EXPECT_NEAR(1000.01, sample.stamp, 1e-6);
    EXPECT_NEAR(M_PI_2, sample.angular_velocity.x(), 1e-6);
    EXPECT_NEAR(0.008, sample.T_vehicle_imu.translation().z(), 1e-6);
    options.imu_pose = "1 2 3 0 0 0";
    EXPECT_NEAR(3, convertedBag(folder, bag, options).frames[1].imu.at(0).T_vehicle_imu(2, 3),
                1e-6);

    const Scan scan = scanWithTimes(0);
    messages.push_back({"/points", "sensor_msgs/PointCloud2", 1001,
                        test::pointCloud2(test::holdsCdr(bag), 1001, test::velodyneFields(scan))});
    test::writeBag(bag, messages);
    EXPECT_TRUE(
        contains(messageOfError<UserError>([&] { (void)convertedBag(folder, bag, options); }),
                 "--imu-topic /front/imu_packets: packets of an IMU are read with those of its "
                 "lidar"));
  }
}

/** The clock of the recorder, which is not that of the headers, would order the scans. */
TEST(BagConverter, BlankMessagesWithoutAStampAreLeftOut)
{
  const TestFolder folder;
  const std::string bag = folder.file("x.mcap");
  const Scan scan = scanWithTimes(0);
  std::vector<test::TestMessage> messages;
  for (int i = 0; i < 6; ++i)
  {
    const bool is_blank = i % 3 == 0;
    messages.push_back({"/points", "sensor_msgs/PointCloud2", 1.7e9 + 0.1 * i,
                        test::pointCloud2(true, is_blank ? 0 : 1000 + 0.1 * i,
                                          test::velodyneFields(is_blank ? Scan() : scan))});
  }
  test::writeBag(bag, messages);
  const Converted converted = convertedBag(folder, bag);
  ASSERT_EQ(4U, converted.frames.size());
  EXPECT_NEAR(1000.1, converted.frames[0].scan.stamp, 1e-6);
  EXPECT_NEAR(1000.5, converted.frames[3].scan.stamp, 1e-6);
  EXPECT_TRUE(converted.result.warnings.empty());

  test::writeBag(bag, {messages[0], messages[3]});
  const std::string message = messageOfError<UserError>([&] { (void)convertedBag(folder, bag); });
  EXPECT_TRUE(contains(message, "/points has 2 messages without points and time stamp")) << message;
}

TEST(BagConverter, ScansAfterAClockThatWasSetBack)
{
  const TestFolder folder;
  const std::string bag = folder.file("x.mcap");
  std::vector<test::TestMessage> messages;
  for (int i = 0; i < 12; ++i)
  {
    const double stamp = (i < 4 ? 1000 : 500) + 0.1 * i;
    messages.push_back({"/points", "sensor_msgs/PointCloud2", 1.7e9 + 0.1 * i,
                        test::pointCloud2(true, stamp, test::velodyneFields(scanWithTimes(0)))});
  }
  test::writeBag(bag, messages);
  EXPECT_EQ(12U, convertedBag(folder, bag).result.scans);
}

/** A bag whose scans have these stamps, in this order. */
std::string bagOf(const TestFolder& folder, const std::vector<double>& stamps)
{
  const std::string bag = folder.file("x.mcap");
  std::vector<test::TestMessage> messages;
  for (std::size_t i = 0; i < stamps.size(); ++i)
  {
    messages.push_back(
        {"/points", "sensor_msgs/PointCloud2", 1.7e9 + 0.1 * static_cast<double>(i),
         test::pointCloud2(true, stamps[i], test::velodyneFields(scanWithTimes(0)))});
  }
  test::writeBag(bag, messages);
  return bag;
}

std::vector<double> stampsOf(const Converted& converted)
{
  std::vector<double> stamps;
  for (const Frame& frame : converted.frames)
  {
    stamps.push_back(frame.scan.stamp);
  }
  return stamps;
}

TEST(BagConverter, ScansOutOfOrderAreSorted)
{
  const TestFolder folder;
  std::vector<double> swapped;
  std::vector<double> in_order;
  for (int i = 0; i < 12; ++i)
  {
    in_order.push_back(1000 + 0.125 * i);
    swapped.push_back(1000 + 0.125 * (i % 2 == 0 ? i + 1 : i - 1));
  }
  const Converted sorted = convertedBag(folder, bagOf(folder, swapped));
  EXPECT_EQ(in_order, stampsOf(sorted));
  EXPECT_TRUE(
      hasLine(sorted.result.notes, "6 scans out of order in the bag; sorted by their stamps"));
  EXPECT_TRUE(sorted.result.warnings.empty());

  std::vector<double> late = in_order;
  std::rotate(late.begin(), late.begin() + 1, late.begin() + 7);  // the first is six scans late
  EXPECT_TRUE(hasLine(convertedBag(folder, bagOf(folder, late)).result.warnings,
                      "the stamp of 1 scan is not after that of the scan before: dyslam leaves it "
                      "out"));
}

TEST(BagConverter, CloudsWithoutCoordinatesOrInMillimetres)
{
  const TestFolder folder;
  const std::string bag = folder.file("x.mcap");
  const auto convert = [&](float factor, double scale)
  {
    std::vector<test::TestMessage> messages;
    for (std::size_t i = 0; i < 4; ++i)
    {
      Scan scan = scanWithTimes(i);
      for (Eigen::Vector3f& point : scan.points)
      {
        point *= factor;
      }
      messages.push_back({"/points", "sensor_msgs/PointCloud2", scan.stamp,
                          test::pointCloud2(true, scan.stamp, test::velodyneFields(scan))});
    }
    test::writeBag(bag, messages);
    ScanConverterOptions options;
    options.scale = scale;
    return convertedBag(folder, bag, options);
  };
  const Converted in_metres = convert(1, 1);
  EXPECT_TRUE(in_metres.result.warnings.empty());
  EXPECT_TRUE(hasLine(convert(std::nanf(""), 1).result.warnings,
                      "4 of 4 scans have no point with coordinates: they are empty, or all "
                      "coordinates are NaN"));
  EXPECT_TRUE(hasLine(convert(1000, 1).result.warnings, "millimetres (--scale 0.001)"));
  const Converted scaled = convert(1000, 0.001);
  EXPECT_TRUE(scaled.result.warnings.empty());
  for (std::size_t i = 0; i < in_metres.frames.at(0).scan.size(); ++i)
  {
    EXPECT_LT((in_metres.frames[0].scan.points[i] - scaled.frames.at(0).scan.points[i]).norm(),
              1e-4);
  }
}

TEST(BagConverter, AJumpOfTheClockIsAWarning)
{
  const TestFolder folder;
  std::vector<double> stamps;
  for (int i = 0; i < 12; ++i)
  {
    stamps.push_back((i < 6 ? 1000 : 4600) + 0.125 * i);
  }
  const auto warnings = convertedBag(folder, bagOf(folder, stamps)).result.warnings;
  ASSERT_EQ(1U, warnings.size());
  EXPECT_EQ(0U, warnings[0].find("the stamps jump forward by 3600 s at scan 6: ")) << warnings[0];
}

TEST(BagConverter, CloudsComeBeforePackets)
{
  const TestFolder folder;
  auto messages = velodyneMessages(false);
  const Scan scan = scanWithTimes(0);
  messages.push_back({"/velodyne_points", "sensor_msgs/PointCloud2", 1001,
                      test::pointCloud2(false, 1001, test::velodyneFields(scan))});
  test::writeBag(folder.file("a.bag"), messages);
  const Converted clouds = convertedBag(folder, folder.file("a.bag"));
  ASSERT_EQ(1U, clouds.frames.size());
  EXPECT_TRUE(clouds.result.warnings.empty());
  EXPECT_TRUE(hasNote(clouds, "--topic chooses other scans: /velodyne_packets"));
  ScanConverterOptions options;
  options.topic = "/velodyne_packets";
  EXPECT_EQ(4U, convertedBag(folder, folder.file("a.bag"), options).frames.size());
  options.topic = "/velodyne_points";
  options.keep_partial = true;
  EXPECT_TRUE(contains(
      messageOfError<UserError>([&] { (void)convertedBag(folder, folder.file("a.bag"), options); }),
      "--keep-partial works with packets only"));
}
}  // namespace dyslam
