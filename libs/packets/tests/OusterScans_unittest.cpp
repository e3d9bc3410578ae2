// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/OusterScans.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ReceivedPacket.h"
#include "SyntheticOuster.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
std::vector<Scan> scansOf(const SyntheticOuster& lidar,
                          const std::vector<std::string>& packets,
                          bool keep_partial = false)
{
  OusterScans decoder("x", parseOusterMetadata(lidar.metadata(), "x.json"), keep_partial);
  std::vector<Scan> scans;
  double time = 1000;
  for (const std::string& bytes : packets)
  {
    const LidarPacket packet = received(bytes, time);
    EXPECT_TRUE(decoder.takes(packet)) << lidar.profile;
    decoder.add(packet);
    time += SyntheticOuster::turn / SyntheticOuster::packets;
    while (auto scan = decoder.take())
    {
      scans.push_back(std::move(*scan));
    }
  }
  decoder.finish();
  while (auto scan = decoder.take())
  {
    scans.push_back(std::move(*scan));
  }
  EXPECT_TRUE(decoder.warnings().empty());
  return scans;
}

/** A point by the formula of the manual; x to the front. */
Eigen::Vector3d pointAt(std::size_t beam, std::size_t column, std::uint32_t range)
{
  const double degree = M_PI / 180;
  const double n = 0.016;
  const double r = 1e-3 * range - n;
  const double encoder = 2 * M_PI * (1 - static_cast<double>(column) / SyntheticOuster::columns);
  const double azimuth = -SyntheticOuster::azimuths()[beam] * degree;
  const double altitude = SyntheticOuster::altitudes()[beam] * degree;
  const double x = r * std::cos(encoder + azimuth) * std::cos(altitude) + n * std::cos(encoder);
  const double y = r * std::sin(encoder + azimuth) * std::cos(altitude) + n * std::sin(encoder);
  const double z = r * std::sin(altitude);
  return {-x, -y, z + 0.036};
}

struct Expected
{
  Eigen::Vector3d point;
  float intensity;
  float time;
  std::uint16_t ring;
};

/** The points of a frame, column by column. */
std::vector<Expected> expectedPoints(bool dual)
{
  std::vector<Expected> points;
  for (std::size_t column = 0; column < SyntheticOuster::columns; ++column)
  {
    const float time = static_cast<float>(SyntheticOuster::turn * static_cast<double>(column) /
                                          SyntheticOuster::columns);
    for (std::size_t beam = 0; beam < SyntheticOuster::beams; ++beam)
    {
      const auto ring = static_cast<std::uint16_t>(SyntheticOuster::beams - 1 - beam);
      const std::uint32_t first = SyntheticOuster::range(beam, column);
      const std::uint32_t second = dual ? SyntheticOuster::secondRange(beam, column) : 0;
      if (first > 0)
      {
        points.push_back({pointAt(beam, column, first),
                          static_cast<float>(SyntheticOuster::reflectivity(beam, column)) / 255,
                          time, ring});
      }
      if (second > 0)
      {
        points.push_back({pointAt(beam, column, second), 77.0F / 255, time, ring});
      }
    }
  }
  return points;
}

/** A capture of three frames of each lidar and of packets of its IMU, all from one address, as
 * ouster-cli saves them. */
std::string captureOfSeveral(const std::vector<SyntheticOuster>& lidars)
{
  std::string file = captureHeader();
  for (std::size_t n = 0; n < 3 * SyntheticOuster::packets; ++n)
  {
    const double time = 1000 + SyntheticOuster::turn * static_cast<double>(n) /
                                   static_cast<double>(SyntheticOuster::packets);
    for (const SyntheticOuster& lidar : lidars)
    {
      const std::string data =
          lidar.packet(n / SyntheticOuster::packets, n % SyntheticOuster::packets);
      appendFrame(file, time, ipFrame(udpDatagram(data, lidar.lidar_port), n, 0));
      const std::string imu = SyntheticOuster::imuPacket(lidar.first_time + 25000000 * n);
      appendFrame(file, time, ipFrame(udpDatagram(imu, lidar.lidar_port + 1), n, 0));
    }
  }
  return file;
}

std::string errorOf(const std::string& metadata)
{
  return messageOfError<UserError>([&] { (void)parseOusterMetadata(metadata, "m.json"); });
}

std::string with(std::string text, const std::string& from, const std::string& to)
{
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}
}  // namespace

TEST(OusterScans, PointsOfEveryProfile)
{
  for (const char* profile :
       {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8",
        "RNG15_RFL8_NIR8_DUAL", "FUSA_RNG15_RFL8_NIR8_DUAL"})
  {
    SyntheticOuster lidar;
    lidar.profile = profile;
    const auto scans = scansOf(lidar, lidar.packetsOf(3));
    ASSERT_EQ(3U, scans.size()) << profile;
    const auto expected = expectedPoints(lidar.profile.find("DUAL") != std::string::npos);
    for (const Scan& scan : scans)
    {
      ASSERT_EQ(expected.size(), scan.size()) << profile;
      for (std::size_t i = 0; i < scan.size(); ++i)
      {
        ASSERT_LT((expected[i].point - scan.points[i].cast<double>()).norm(), 1e-5) << profile;
        ASSERT_FLOAT_EQ(expected[i].intensity, scan.intensity[i]) << profile;
        ASSERT_NEAR(expected[i].time, scan.time[i], 1e-6) << profile;
        ASSERT_EQ(expected[i].ring, scan.ring[i]) << profile;
      }
      EXPECT_EQ("OS-1-4", scan.sensor_label);
    }
    EXPECT_NEAR(1000, scans[0].stamp, 1e-6);
    EXPECT_NEAR(SyntheticOuster::turn, scans[1].stamp - scans[0].stamp, 1e-6);
  }
}

TEST(OusterScans, LeavesOutIncompleteFrames)
{
  const SyntheticOuster lidar;
  auto packets = lidar.packetsOf(4, 1);  // without the first
  packets.pop_back();
  EXPECT_EQ(2U, scansOf(lidar, packets).size());
  EXPECT_EQ(4U, scansOf(lidar, packets, true).size());
  packets.erase(packets.begin() + 5);  // one that was lost on the way
  const auto scans = scansOf(lidar, packets);
  ASSERT_EQ(2U, scans.size());
  EXPECT_LT(scans[0].size(), scans[1].size());
}

TEST(OusterScans, AWindowIsAWholeFrame)
{
  SyntheticOuster lidar;
  lidar.first_column = 8;
  lidar.last_column = 40;
  EXPECT_EQ(3U, scansOf(lidar, lidar.packetsOf(3)).size());
  EXPECT_EQ(2U, scansOf(lidar, lidar.packetsOf(3, 2)).size());
  for (const std::size_t frames : {1U, 2U})  // no other frame tells where one begins and ends
  {
    EXPECT_EQ(frames, scansOf(lidar, lidar.packetsOf(frames)).size());
  }
  EXPECT_TRUE(scansOf(lidar, lidar.packetsOf(1, 1)).empty());
}

TEST(OusterScans, AFrameThatBeginsWithoutReturnsIsWhole)
{
  SyntheticOuster lidar;
  lidar.sky_columns = 8;
  const auto scans = scansOf(lidar, lidar.packetsOf(3));
  ASSERT_EQ(3U, scans.size());
  EXPECT_LT(scans[0].size(), scans[1].size());
  EXPECT_NEAR(1000, scans[0].stamp, 1e-6);
  EXPECT_NEAR(SyntheticOuster::turn, scans[1].stamp - scans[0].stamp, 1e-6);
}

TEST(OusterScans, PacketsThatOvertakeEachOther)
{
  const SyntheticOuster lidar;
  auto packets = lidar.packetsOf(3);
  std::swap(packets[4], packets[5]);  // within a frame
  const auto scans = scansOf(lidar, packets);
  ASSERT_EQ(3U, scans.size());
  EXPECT_EQ(scans[0].size(), scans[1].size());
  EXPECT_EQ(0, *std::min_element(scans[1].time.begin(), scans[1].time.end()));
  EXPECT_NEAR(SyntheticOuster::turn, scans[1].stamp - scans[0].stamp, 1e-6);
  packets = lidar.packetsOf(3);
  std::swap(packets[3], packets[4]);  // the last of a frame behind the first of the next
  OusterScans decoder("x", parseOusterMetadata(lidar.metadata(), "x.json"), true);
  for (const std::string& packet : packets)
  {
    decoder.add(received(packet));
  }
  decoder.finish();
  ASSERT_EQ(1U, decoder.warnings().size());
  EXPECT_TRUE(contains(decoder.warnings()[0], "x: 1 packet of an earlier frame left out"));
}

TEST(OusterScans, TakesItsOwnPacketsOnly)
{
  SyntheticOuster lidar;
  const OusterScans decoder("x", parseOusterMetadata(lidar.metadata(), "x.json"), false);
  const std::string own = lidar.packet(0, 0);
  EXPECT_TRUE(decoder.takes(received(own)));
  EXPECT_FALSE(decoder.takes(received(own.substr(1))));
  EXPECT_TRUE(decoder.takes(received(own + '\0'))) << "as early drivers recorded them";
  lidar.sensor = 42;
  EXPECT_FALSE(decoder.takes(received(lidar.packet(0, 0)))) << "of another lidar";
  std::string imu = own;
  imu[0] = 2;
  EXPECT_FALSE(decoder.takes(received(imu))) << "of another kind";
}

TEST(OusterScans, SynchronisedClocksAreKept)
{
  SyntheticOuster lidar;
  lidar.first_time = 999700000000;  // 0.3 s before the capture, whose network was slow
  const auto scans = scansOf(lidar, lidar.packetsOf(2));
  ASSERT_EQ(2U, scans.size());
  EXPECT_NEAR(999.7, scans[0].stamp, 1e-6);
}

TEST(OusterScans, AClockThatIsSetWithinAFrame)
{
  SyntheticOuster lidar;
  auto packets = lidar.packetsOf(3);
  constexpr double packet_time = SyntheticOuster::turn / SyntheticOuster::packets;
  lidar.first_time += 1700000000ULL * 1000000000ULL;  // PTP locks
  const auto later = lidar.packetsOf(3);
  std::copy(later.begin() + 6, later.end(), packets.begin() + 6);
  const auto scans = scansOf(lidar, packets);
  ASSERT_EQ(3U, scans.size());
  for (const Scan& scan : scans)
  {
    EXPECT_NEAR(0.1, *std::max_element(scan.time.begin(), scan.time.end()), packet_time);
  }
  EXPECT_NEAR(1000.1, scans[1].stamp, packet_time);
  EXPECT_NEAR(1000.2, scans[2].stamp, packet_time);
}

TEST(OusterScans, PacketsThatWereCapturedTwice)
{
  const SyntheticOuster lidar;
  OusterScans decoder("x", parseOusterMetadata(lidar.metadata(), "x.json"), false);
  for (const std::string& packet : lidar.packetsOf(2))
  {
    decoder.add(received(packet));
    decoder.add(received(packet));
  }
  decoder.finish();
  const auto scan = decoder.take();
  ASSERT_TRUE(scan);
  EXPECT_EQ(expectedPoints(false).size(), scan->size());
  ASSERT_EQ(1U, decoder.warnings().size());
  EXPECT_TRUE(contains(decoder.warnings()[0], "x: 128 columns received twice"));
}

TEST(OusterScans, PacketsOfAnotherInitialization)
{
  for (const char* profile : {"RNG19_RFL8_SIG16_NIR16", "FUSA_RNG15_RFL8_NIR8_DUAL"})
  {
    SyntheticOuster lidar;
    lidar.profile = profile;
    OusterScans decoder("x", parseOusterMetadata(lidar.metadata(), "x.json"), true);
    for (const std::uint32_t initialization : {7U, 0U})  // 0: not stated
    {
      lidar.initialization = initialization;
      for (const std::string& packet : lidar.packetsOf(1))
      {
        ASSERT_TRUE(decoder.takes(received(packet))) << profile;
        decoder.add(received(packet));
      }
      decoder.finish();
      lidar.first_time += 1000000000;
    }
    const auto warnings = decoder.warnings();
    ASSERT_EQ(1U, warnings.size()) << profile;
    EXPECT_TRUE(contains(warnings[0], "x: 4 packets of another initialization of the sensor"));
  }
}

TEST(OusterScans, LegacyPacketsOfAnotherMode)
{
  SyntheticOuster lidar;
  lidar.profile = "LEGACY";
  const std::string other =
      with(lidar.metadata(), "\"columns_per_frame\": 64", "\"columns_per_frame\": 128");
  OusterScans decoder("x", parseOusterMetadata(other, "x.json"), true);
  for (const std::string& packet : lidar.packetsOf(1))
  {
    decoder.add(received(packet));
  }
  const auto warnings = decoder.warnings();
  ASSERT_EQ(1U, warnings.size());
  EXPECT_TRUE(contains(warnings[0], "x: 3 packets with another number of columns"))
      << "column 0 of the first one has no angle";
}

TEST(OusterMetadata, WindowOfColumns)
{
  using Window = std::pair<std::size_t, std::size_t>;
  const auto windowOf = [](std::size_t first, std::size_t last)
  {
    SyntheticOuster lidar;
    lidar.first_column = first;
    lidar.last_column = last;
    const OusterMetadata metadata = parseOusterMetadata(lidar.metadata(), "m.json");
    return Window(metadata.first_column, metadata.last_column);
  };
  EXPECT_EQ(Window(8, 40), windowOf(8, 40));
  EXPECT_EQ(Window(0, 63), windowOf(40, 8)) << "with the connector, where frames begin";
  EXPECT_EQ(Window(0, 63), windowOf(8, 64)) << "of another mode";
}

TEST(OusterMetadata, SectionsOrNone)
{
  const SyntheticOuster lidar;
  const OusterMetadata a = parseOusterMetadata(lidar.metadata(false), "a");
  const OusterMetadata b = parseOusterMetadata(lidar.metadata(true), "b");
  for (const OusterMetadata& m : {a, b})
  {
    EXPECT_EQ("OS-1-4", m.product);
    EXPECT_EQ(SyntheticOuster::serial, m.serial);
    EXPECT_EQ(lidar.initialization, m.initialization);
    EXPECT_EQ(7502, m.lidar_port);
    EXPECT_EQ(7503, m.imu_port);
    EXPECT_EQ("RNG19_RFL8_SIG16_NIR16", m.profile.name);
    EXPECT_EQ(4U, m.beams());
    EXPECT_EQ(64U, m.columns);
    EXPECT_EQ(16U, m.packet_columns);
    EXPECT_DOUBLE_EQ(0.016, m.origin_outwards);
    EXPECT_DOUBLE_EQ(0.036, m.T_sensor_lidar.translation().z());
    EXPECT_EQ(32U + 16 * (12 + 4 * 12) + 32, OusterScans::packetSize(m));
  }
  const OusterMetadata old = parseOusterMetadata(
      R"({"lidar_mode": "512x20", "beam_altitude_angles": [1, 2], "beam_azimuth_angles": [0, 0]})",
      "old");
  EXPECT_TRUE(old.profile.isLegacy());
  EXPECT_EQ(0U, old.initialization);
  EXPECT_EQ(0, old.lidar_port);
  EXPECT_EQ(512U, old.columns);
  EXPECT_DOUBLE_EQ(-1, old.T_sensor_lidar.linear()(0, 0));
}

TEST(OusterMetadata, ErrorsNameTheValue)
{
  const std::string good = SyntheticOuster().metadata();
  EXPECT_TRUE(contains(errorOf("text"), "m.json: is not JSON"));
  EXPECT_TRUE(contains(errorOf(std::string(100000, '[')), "m.json: is not JSON"));
  EXPECT_TRUE(contains(errorOf(with(good, "RNG19", "RNG99")), "udp_profile_lidar RNG99"));
  EXPECT_TRUE(contains(errorOf(with(good, "[3, 1", "[1")), "beam_azimuth_angles has 3 angles"));
  EXPECT_TRUE(contains(errorOf(with(good, "[20, 5", "[\"20\", 5")),
                       "beam_altitude_angles is not a list of numbers"));
  EXPECT_TRUE(contains(errorOf(with(good, "[20, 5, -5.5, -20]", "[0, 0, 0, 0]")), "are all 0"));
  EXPECT_TRUE(contains(errorOf(with(good, "\"columns_per_frame\": 64", "\"a\": 1")),
                       "columns_per_frame is missing"));
  EXPECT_TRUE(contains(errorOf(with(good, "\"pixels_per_column\": 4", "\"pixels_per_column\": 8")),
                       "pixels_per_column is not"));
  EXPECT_TRUE(contains(errorOf(with(good, "[-1,0,0,0", "[-2,0,0,0")),
                       "lidar_to_sensor_transform is no pose"));
}

TEST(PcapSource, OusterWithMetadataBeside)
{
  const SyntheticOuster lidar;
  const TestFolder folder;
  const std::string path = folder.write("drive.pcap", lidar.capture(lidar.packetsOf(3)));
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { PcapSource source(path); }),
               "but UDP packets of 1024 bytes (port 7502); of an Ouster, put its metadata"));
  folder.write("other.json", "{}");
  SyntheticOuster old;
  old.profile = "LEGACY";
  folder.write("a.json", old.metadata());
  folder.write("drive.json", old.metadata());                    // does not fit, whatever its name
  folder.write("drive.0.json", "{\"beam_altitude_angles\": 0");  // damaged
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { PcapSource source(path); }),
                       "has no data packets of the lidar of"));
  const std::string metadata = folder.write("drive_0.json", lidar.metadata(true));
  // In one piece, and in fragments as they are on the wire.
  const std::string cut = folder.write("drive_cut.pcap", lidar.capture(lidar.packetsOf(3), 256));
  for (const std::string& capture : {path, cut})
  {
    PcapSource source(capture);
    ASSERT_EQ(1U, source.notes().size());
    EXPECT_EQ("metadata of the lidar: " + metadata, source.notes()[0]);
    EXPECT_EQ("OS-1-4", source.sensor());
    const std::size_t points = expectedPoints(false).size();
    for (int i = 0; i < 3; ++i)
    {
      const auto scan = source.next();
      ASSERT_TRUE(scan) << capture;
      EXPECT_EQ(points, scan->size());
      EXPECT_NEAR(1000 + i * SyntheticOuster::turn, scan->stamp, 1e-6);
    }
    EXPECT_FALSE(source.next());
    EXPECT_TRUE(source.warnings().empty());
  }
  PcapSourceOptions options;
  options.calibration_file = folder.write("metadata.txt", lidar.metadata());
  EXPECT_EQ("OS-1-4", PcapSource(path, options).sensor());
  options.calibration_file = folder.file("a.json");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { PcapSource source(path, options); }),
                       "has no data packets of the lidar of"));
}

TEST(PcapSource, OusterMetadataOfTheSameMode)
{
  for (const char* profile : {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "FUSA_RNG15_RFL8_NIR8_DUAL"})
  {
    SyntheticOuster lidar;
    lidar.profile = profile;
    SyntheticOuster earlier = lidar;
    earlier.initialization = 7;
    const TestFolder folder;
    const std::string path = folder.write("drive.pcap", lidar.capture(lidar.packetsOf(3)));
    folder.write("drive.json", with(earlier.metadata(), "\"columns_per_frame\": 64",
                                    "\"columns_per_frame\": 128"));
    const std::string own = folder.write("a.json", lidar.metadata());
    PcapSource source(path);
    EXPECT_EQ(std::vector<std::string>{"metadata of the lidar: " + own}, source.notes());
    const auto scan = source.next();
    ASSERT_TRUE(scan) << profile;
    const Eigen::Vector3d last = scan->points.back().cast<double>();
    EXPECT_LT((expectedPoints(lidar.isFusa()).back().point - last).norm(), 1e-5);
    EXPECT_TRUE(source.warnings().empty()) << profile;
  }
}

TEST(PcapSource, ThePoseThatOustersSdkWasTold)
{
  const SyntheticOuster lidar;
  const TestFolder folder;
  const std::string path = folder.write("drive.pcap", lidar.capture(lidar.packetsOf(3)));
  const std::string none = lidar.metadata(true);
  const auto told = [&](const std::string& pose)
  { return none.substr(0, none.size() - 1) + ", \"ouster-sdk\": {\"extrinsic\": " + pose + "}}"; };
  folder.write("drive.json", told("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]"));
  EXPECT_EQ(1U, PcapSource(path).notes().size()) << "the identity";
  folder.write("drive.json", told("[0,-1,0,0.5, 1,0,0,0, 0,0,1,1.25, 0,0,0,1]"));
  const PcapSource source(path);
  ASSERT_EQ(2U, source.notes().size());
  EXPECT_EQ(
      "the metadata place the lidar on its vehicle, which is done by --sensor-pose '0.5 0 1.25 90 "
      "0 0'",
      source.notes()[1]);
}

TEST(PcapSource, OustersWithoutSerialNumbersAreToldByTheirPorts)
{
  SyntheticOuster front;
  front.profile = "LEGACY";
  SyntheticOuster rear = front;
  rear.lidar_port = 7504;
  rear.first_time += 1000000;
  rear.sky_columns = 8;
  const TestFolder folder;
  const std::string both = folder.write("drive.pcap", captureOfSeveral({front, rear}));
  const std::string of_rear = folder.write("drive_0.json", rear.metadata());
  const std::string of_front = folder.write("drive_1.json", front.metadata());
  PcapSourceOptions options;
  options.imu = true;
  for (const std::string& metadata : {of_rear, of_front})
  {
    options.calibration_file = metadata == of_front ? of_front : "";
    PcapSource source(both, options);
    const auto first = source.next();
    const auto second = source.next();
    ASSERT_TRUE(first && second);
    EXPECT_EQ(metadata == of_rear, first->size() < second->size());
    while (source.next())
    {
    }
    EXPECT_EQ(12U, source.imuPackets());
    EXPECT_EQ(12U, source.takeImu().size());
  }
  const std::string one = folder.write("drive_0.pcap", captureOfSeveral({front}));
  EXPECT_EQ("metadata of the lidar: " + of_front, PcapSource(one).notes().at(0));
}

TEST(PcapSource, OusterMetadataWithoutAPortAreChosenByTheirName)
{
  SyntheticOuster lidar;
  lidar.profile = "LEGACY";
  const TestFolder folder;
  folder.write("a.json", lidar.metadata());
  std::string reduced = lidar.metadata();
  reduced.replace(reduced.find("udp_port_lidar"), 3, "tcp");
  const std::string own = folder.write("drive.json", reduced);
  const std::string path = folder.write("drive.pcap", captureOfSeveral({lidar}));
  EXPECT_EQ("metadata of the lidar: " + own, PcapSource(path).notes().at(0));
}

TEST(PcapSource, OtherOustersWhoseMetadataAreBesideAreNamed)
{
  const SyntheticOuster front;
  SyntheticOuster rear;
  rear.sensor = 42;
  const TestFolder folder;
  const std::string path = folder.write("drive.pcap", captureOfSeveral({front, rear}));
  folder.write("drive_0.json", front.metadata());
  const std::string other = folder.write("drive_1.json", rear.metadata());
  PcapSource source(path);
  while (source.next())
  {
  }
  const auto warnings = source.warnings();
  ASSERT_EQ(1U, warnings.size());
  EXPECT_EQ(path + ": has packets of other lidars, too; --calibration with their metadata reads " +
                "them: " + other,
            warnings[0]);
}
}  // namespace dyslam
