// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/HesaiPackets.h>
#include <dyslam/packets/HesaiScans.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "ReceivedPacket.h"
#include "SyntheticHesai.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::vector<HesaiKind> designed{HesaiKind::pandar40, HesaiKind::pandar64, HesaiKind::xt16,
                                      HesaiKind::xt32,     HesaiKind::xt32m2x,  HesaiKind::qt64};

std::vector<Scan> scansOf(const SyntheticHesai& lidar,
                          double duration,
                          const HesaiScansOptions& options = {})
{
  HesaiScans scans("lidar.pcap", options);
  std::vector<Scan> all;
  for (std::size_t n = 0; static_cast<double>(n) * lidar.packetTime() < duration; ++n)
  {
    const double time = static_cast<double>(n) * lidar.packetTime();
    const LidarPacket packet = received(lidar.packet(n), 2000 + time);
    EXPECT_TRUE(scans.takes(packet));
    scans.add(packet);
  }
  scans.finish();
  while (auto scan = scans.take())
  {
    all.push_back(std::move(*scan));
  }
  return all;
}

/** Channel,elevation,azimuth: each a degree below the one before. */
std::string angleFile(std::size_t lasers)
{
  std::string text = "Laser id,Elevation,Azimuth\r\n";
  for (std::size_t i = 0; i < lasers; ++i)
  {
    text += std::to_string(i + 1) + "," + std::to_string(20 - static_cast<int>(i)) + ",2.5\r\n";
  }
  return text;
}

std::string messageFor(const SyntheticHesai& lidar, const HesaiScansOptions& options)
{
  try
  {
    (void)scansOf(lidar, 0.01, options);
  }
  catch (const UserError& error)
  {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(HesaiScans, EveryModelGivesARevolutionPerScan)
{
  for (const HesaiKind kind : designed)
  {
    SyntheticHesai lidar;
    lidar.kind = kind;
    lidar.first_azimuth = 90;
    const std::vector<Scan> scans = scansOf(lidar, 0.38);
    ASSERT_EQ(scans.size(), 3U) << static_cast<int>(kind);
    const std::size_t lasers = lidar.shape().lasers;
    for (const Scan& scan : scans)
    {
      const double firings = SyntheticHesai::turn / lidar.shape().period;
      const auto points = static_cast<double>(scan.points.size());
      const auto seen = static_cast<double>(lasers - 1);
      EXPECT_NEAR(points, firings * seen, 2 * seen);
      for (std::size_t i = 0; i < scan.points.size(); ++i)
      {
        ASSERT_NEAR(scan.points[i].norm(), 12, 1e-3);
        ASSERT_LT(scan.ring[i], lasers);
        ASSERT_GE(scan.time[i], 0);
        ASSERT_LT(scan.time[i], 1.01 * SyntheticHesai::turn);
        ASSERT_FLOAT_EQ(scan.intensity[i], 0x33 / 255.0F);
      }
      EXPECT_TRUE(std::is_sorted(scan.time.begin(), scan.time.end()));
    }
    EXPECT_NEAR(scans[1].stamp - scans[0].stamp, SyntheticHesai::turn, 1e-3);
    EXPECT_EQ(scans[0].sensor_label, hesaiLayoutOf(received(lidar.packet(0)))->name);
  }
}

TEST(HesaiScans, ALidarMayTurnTheOtherWay)
{
  SyntheticHesai lidar;
  lidar.clockwise = false;
  const std::vector<Scan> scans = scansOf(lidar, 0.38);
  ASSERT_EQ(scans.size(), 3U);
  for (const Scan& scan : scans)
  {
    EXPECT_NEAR(static_cast<double>(scan.points.size()), 2000 * 31, 2 * 31);
    EXPECT_LT(scan.time.back(), 1.01 * SyntheticHesai::turn);
  }
}

TEST(HesaiScans, PointsAreInTheFrameOfTheMakersDrivers)
{
  HesaiScansOptions options;
  options.keep_partial = true;
  SyntheticHesai lidar;  // XT32: channel 1 is 15 deg up, channel 16 level
  const std::vector<Scan> scans = scansOf(lidar, 0.02, options);
  ASSERT_EQ(scans.size(), 1U);
  const Scan& scan = scans[0];
  constexpr std::size_t seen = 31;  // of the 32 channels
  // Azimuth 0 is y; a firing later the beam is further to the right, which is x.
  EXPECT_TRUE(scan.points[14].isApprox(Eigen::Vector3f(0, 12, 0), 1e-4F));
  EXPECT_NEAR(scan.points[0].z(), 12 * std::sin(15 * M_PI / 180), 1e-4);
  EXPECT_EQ(scan.ring[0], 31);
  EXPECT_EQ(scan.ring[14], 16);
  const double turned = 0.18 * M_PI / 180;
  EXPECT_NEAR(scan.points[seen + 14].x(), 12 * std::sin(turned), 1e-4);
  EXPECT_NEAR(scan.time[seen], 50e-6, 1e-8);
}

TEST(HesaiScans, ASecondReturnIsKeptWhereItDiffers)
{
  for (const HesaiKind kind : designed)
  {
    SyntheticHesai lidar;
    lidar.kind = kind;
    HesaiScansOptions options;
    options.keep_partial = true;
    const auto single = scansOf(lidar, 0.01, options);
    lidar.dual = true;
    const auto both = scansOf(lidar, 0.01, options);
    ASSERT_EQ(single.size(), 1U);
    ASSERT_EQ(both.size(), 1U);
    const auto further = std::count_if(both[0].points.begin(), both[0].points.end(),
                                       [](const auto& p) { return p.norm() > 13; });
    const std::size_t seen = lidar.shape().lasers - 1;
    EXPECT_EQ(both[0].points.size() / (seen + 1), static_cast<std::size_t>(further));
    EXPECT_NEAR(both[0].time.back(), single[0].time.back(), 2e-3);
  }
}

TEST(HesaiScans, TheClockOfTheSensorIsUsedIfItIsSet)
{
  HesaiScansOptions options;
  options.keep_partial = true;
  for (const HesaiKind kind : designed)
  {
    SyntheticHesai lidar;
    lidar.kind = kind;
    const std::string first = lidar.packet(0);
    HesaiScans scans("x", options);
    scans.add(received(first, 1e9 + 0.2));  // received 0.2 s later
    scans.finish();
    EXPECT_NEAR(scans.take()->stamp, 1e9, 1e-5) << static_cast<int>(kind);
    EXPECT_NEAR(scansOf(lidar, 0.01, options)[0].stamp, 2000, 1e-3);  // far from the capture's
    lidar.years_from_2000 = true;
    HesaiScans others("x", options);
    others.add(received(lidar.packet(0), 1e9 + 0.2));
    others.finish();
    EXPECT_NEAR(others.take()->stamp, 1e9, 1e-5) << static_cast<int>(kind);
  }
}

TEST(HesaiScans, ALidarsOwnAnglesAreRead)
{
  const TestFolder folder;
  std::ofstream(folder.file("qt.csv")) << angleFile(128);
  HesaiScansOptions options;
  options.keep_partial = true;
  for (const HesaiKind kind : {HesaiKind::qt128, HesaiKind::ot128})
  {
    SyntheticHesai lidar;
    lidar.kind = kind;
    options.angle_file = "";
    EXPECT_NE(messageFor(lidar, options).find("--calibration"), std::string::npos);
    options.angle_file = folder.file("qt.csv");
    const auto scans = scansOf(lidar, 0.01, options);
    ASSERT_EQ(scans.size(), 1U);
    const Eigen::Vector3f first = scans[0].points.front();
    EXPECT_NEAR(std::asin(first.z() / 12) * 180 / M_PI, 20, 1e-3);
    EXPECT_NEAR(std::atan2(first.x(), first.y()) * 180 / M_PI, 2.5, 1e-3);
  }
  SyntheticHesai lidar;
  EXPECT_NE(messageFor(lidar, options).find("has the angles of 128 lasers"), std::string::npos);
  options.angle_file = folder.file("none.csv");
  EXPECT_NE(messageFor(lidar, options).find("none.csv"), std::string::npos);
  options.angle_file = folder.file(".");
  EXPECT_NE(messageFor(lidar, options).find("is a folder"), std::string::npos);
  std::ofstream(folder.file("gap.csv")) << "1,2,3\n3,4,5\n";
  options.angle_file = folder.file("gap.csv");
  EXPECT_NE(messageFor(lidar, options).find("channel 3 follows channel 1"), std::string::npos);
}

TEST(HesaiScans, OtherPacketsAreNotTaken)
{
  const SyntheticHesai lidar;
  EXPECT_TRUE(HesaiScans::isPacket(received(lidar.packet(0))));
  EXPECT_FALSE(HesaiScans::isPacket(received(velodynePacket(0))));
  EXPECT_FALSE(HesaiScans::isPacket(received(lidar.packet(0).substr(0, 900))));
  EXPECT_FALSE(HesaiScans::isPacket(
      received(std::string("\xee\xff\x04\x03", 4) + std::string(1000, '\x20'))));  // AT128
  EXPECT_FALSE(HesaiScans::isPacket(received("")));
  SyntheticHesai other;
  other.kind = HesaiKind::xt16;
  HesaiScans scans("x", {});
  scans.add(received(lidar.packet(0)));
  EXPECT_FALSE(scans.takes(received(other.packet(0))));
}

TEST(HesaiScans, ACaptureIsRecognised)
{
  const TestFolder folder;
  SyntheticHesai lidar;
  lidar.first_azimuth = 180;
  std::ofstream(folder.file("xt.pcap"), std::ios::binary) << capturedHesai(lidar, 0.31);
  PcapSource source(folder.file("xt.pcap"));
  std::size_t scans = 0;
  while (auto scan = source.next())
  {
    ++scans;
    EXPECT_EQ(scan->sensor_label, "XT32");
  }
  EXPECT_EQ(scans, 3U);
  EXPECT_EQ(source.sensor(), "XT32");

  // Also among more packets of something else.
  std::string mixed = captureHeader();
  for (std::size_t n = 0; n < 700; ++n)
  {
    const double time = 1000 + static_cast<double>(n) * lidar.packetTime();
    appendFrame(mixed, time, ipFrame(udpDatagram(lidar.packet(n), 2368), 0, 0));
    for (int k = 0; k < 3; ++k)
    {
      appendFrame(mixed, time, ipFrame(udpDatagram(std::string(1000, 'v'), 5004), 0, 0));
    }
  }
  std::ofstream(folder.file("mixed.pcap"), std::ios::binary) << mixed;
  EXPECT_EQ(PcapSource(folder.file("mixed.pcap")).sensor(), "XT32");
  PcapSourceOptions options;
  std::ofstream(folder.file("own.csv")) << angleFile(40);
  options.calibration_file = folder.file("own.csv");
  EXPECT_THROW(PcapSource(folder.file("xt.pcap"), options), UserError);
}
}  // namespace dyslam
