// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "Revolutions.h"
#include "SyntheticCapture.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::packet_time;
using test::revolutionsOf;

constexpr std::size_t file_header = 24;
constexpr std::size_t record_header = 16;
constexpr std::size_t data_offset = record_header + 42;  //!< Ethernet, IP and UDP headers
constexpr std::size_t record_size = data_offset + 1206;

void put(std::string& bytes, std::size_t at, std::uint32_t value)
{
  std::memcpy(&bytes[at], &value, sizeof value);
}

/** The same capture with other times, both functions of those since its first packet [s]. */
template <typename Captured, typename Clock>
std::string withTimes(std::string capture, const Captured& captured_at, const Clock& clock)
{
  std::size_t n = 0;
  for (std::size_t at = file_header; at < capture.size(); at += record_size, ++n)
  {
    const double time = static_cast<double>(n) * packet_time;
    const double seconds = captured_at(time);
    put(capture, at, static_cast<std::uint32_t>(seconds));
    put(capture, at + 4, static_cast<std::uint32_t>(std::fmod(seconds, 1.0) * 1e6));
    put(capture, at + data_offset + 1200,
        static_cast<std::uint32_t>(std::fmod(clock(time), 3600.0) * 1e6));
  }
  return capture;
}

TEST(PcapSource, CutsRevolutionsAndPlacesPoints)
{
  const TestFolder folder;
  const std::string path = folder.write("a.pcap", captured(300));  // 3.98 turns from 0 degrees
  PcapSourceOptions options;
  options.cut_azimuth = 0;
  const auto revolutions = revolutionsOf(path, options).scans;
  ASSERT_EQ(3U, revolutions.size());  // the last is broken
  for (std::size_t n = 0; n < 3; ++n)
  {
    const Scan& scan = revolutions[n];
    EXPECT_NEAR(1000.0 + 0.1 * static_cast<double>(n), scan.stamp, 0.002);
    EXPECT_NEAR(0.1 / (2 * 55.296e-6) * 30, static_cast<double>(scan.size()), 64);
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      const auto& p = scan.points[i];
      ASSERT_NEAR(10.0F, p.norm(), 1e-3F);
      ASSERT_NEAR(-15.0 + 2.0 * scan.ring[i], std::asin(p.z() / 10.0F) * 180 / M_PI, 0.01);
      ASSERT_NE(9, scan.ring[i]);  // laser 3, at +3 degrees, saw nothing
      // Clockwise from ahead at 10 Hz.
      const double azimuth = std::fmod(2 * M_PI - std::atan2(p.y(), p.x()), 2 * M_PI);
      const double when = scan.stamp - 1000.0 - 0.1 * static_cast<double>(n) + scan.time[i];
      const double error = std::remainder(azimuth - when * 20 * M_PI, 2 * M_PI);
      ASSERT_NEAR(0, error, 0.0006) << i;
      ASSERT_FLOAT_EQ(0.2F, scan.intensity[i]);
    }
  }
  options.keep_partial = true;
  EXPECT_EQ(4U, revolutionsOf(path, options).scans.size());
}

TEST(PcapSource, TheSensorsClockCountsWhateverTheCapturesDoes)
{
  const TestFolder folder;
  PcapSourceOptions options;
  options.cut_azimuth = 0;
  const auto clock = [](double time) { return 3599.5 + time; };
  const auto expectSteady = [&](const std::string& capture, const char* what)
  {
    const auto scans = revolutionsOf(folder.write("a.pcap", capture), options).scans;
    ASSERT_EQ(21U, scans.size()) << what;
    for (std::size_t i = 0; i < scans.size(); ++i)
    {
      EXPECT_NEAR(0.1 * static_cast<double>(i), scans[i].stamp - scans[0].stamp, 0.003) << what;
      EXPECT_NEAR(0.1, scans[i].time.back(), 0.003) << what;
      EXPECT_NEAR(0, scans[i].time.front(), 0.003) << what;
    }
  };
  const std::string capture = captured(1600);
  expectSteady(withTimes(
                   capture, [](double) { return 0; }, clock),
               "no capture times");
  expectSteady(withTimes(
                   capture, [](double time) { return 1000 + 3 * time; }, clock),
               "a drift");
  expectSteady(
      withTimes(
          capture, [](double time) { return time < 1.05 ? 1000 + time : 500 + time; }, clock),
      "the capture's clock is set");
  for (const double set : {-100.0, 1000.0})
  {
    expectSteady(withTimes(
                     capture, [](double time) { return 1000 + time; },
                     [set](double time) { return 500 + time + (time < 1.05 ? 0 : set); }),
                 "the sensor's clock is set");
  }
}

TEST(PcapSource, PausesAreKept)
{
  const TestFolder folder;
  PcapSourceOptions options;
  options.cut_azimuth = 0;
  for (const double pause : {10.0, 2000.0, 5000.0})
  {
    const auto times = [pause](double time) { return 1000 + time + (time < 1.05 ? 0 : pause); };
    const std::string path = folder.write("a.pcap", withTimes(captured(1600), times, times));
    const auto scans = revolutionsOf(path, options).scans;
    ASSERT_EQ(22U, scans.size()) << "the revolution with the pause is two scans";
    EXPECT_NEAR(pause + 2.0, scans.back().stamp - scans.front().stamp, 0.003);
    for (const Scan& scan : scans)
    {
      EXPECT_LT(scan.time.back(), 0.103);
    }
  }
}

/** The blocks of a packet then lie on both sides of the sector. */
TEST(PcapSource, ASectorThatIsLeftOut)
{
  const TestFolder folder;
  constexpr double block_time = packet_time / 12;
  for (const auto& [begin, end] : {std::pair(300, 60), std::pair(10, 50), std::pair(100, 260)})
  {
    std::string capture = captureHeader();
    std::vector<double> blocks;
    for (std::size_t n = 0; n < 19000; ++n)
    {
      const double time = static_cast<double>(n) * block_time;
      const double azimuth = std::fmod(time * 3600, 360);
      const bool is_seen =
          begin < end ? azimuth >= begin && azimuth <= end : azimuth >= begin || azimuth <= end;
      if (is_seen)
      {
        blocks.push_back(time);
      }
      if (blocks.size() == 12)
      {
        appendFrame(capture, 1000 + blocks.back(),
                    ipFrame(udpDatagram(velodynePacketOf(blocks), 2368), 0, 0));
        blocks.clear();
      }
    }
    const auto scans = revolutionsOf(folder.write("a.pcap", capture)).scans;
    ASSERT_GE(scans.size(), 19U) << begin;
    ASSERT_LE(scans.size(), 22U) << begin;
    for (std::size_t i = 0; i < scans.size(); ++i)
    {
      EXPECT_NEAR(0.1 * static_cast<double>(i), scans[i].stamp - scans[0].stamp, 0.0008) << begin;
      for (std::size_t k = 0; k < scans[i].size(); ++k)
      {
        // Clockwise from ahead at 10 Hz, from the first block on.
        const auto& p = scans[i].points[k];
        const double turned =
            2 * M_PI * 10 * (scans[i].time[k] + scans[i].stamp - scans[0].stamp) -
            (std::atan2(scans[0].points[0].y(), scans[0].points[0].x()) - std::atan2(p.y(), p.x()));
        ASSERT_NEAR(0, std::remainder(turned, 2 * M_PI), 0.05) << begin << ", " << i << ", " << k;
      }
    }
  }
}

TEST(PcapSource, APacketThatIsOvertakenAtTheCut)
{
  const TestFolder folder;
  std::string capture = captureHeader();
  for (std::size_t n = 0; n < 700; ++n)
  {
    // The packets on either side of the first cut, at 0.05 s, in the other order.
    const std::size_t sent = n == 37 ? 38 : n == 38 ? 37 : n;
    const double time = static_cast<double>(sent) * packet_time;
    appendFrame(capture, 1000 + static_cast<double>(n) * packet_time,
                ipFrame(udpDatagram(velodynePacket(time), 2368), 0, 0));
  }
  const auto scans = revolutionsOf(folder.write("a.pcap", capture)).scans;
  ASSERT_EQ(8U, scans.size());
  for (const Scan& scan : scans)
  {
    EXPECT_NEAR(0.1 / (2 * 55.296e-6) * 30, static_cast<double>(scan.size()), 800);
  }
}

TEST(PcapSource, NearReturnsAreKept)
{
  const TestFolder folder;
  std::string capture = captured(300);
  for (std::size_t at = file_header; at < capture.size(); at += record_size)
  {
    for (std::size_t block = 0; block < 12; ++block)
    {
      capture[at + data_offset + 100 * block + 4] = static_cast<char>(100);  // laser 0, 0.2 m
      capture[at + data_offset + 100 * block + 5] = 0;
    }
  }
  const std::string path = folder.write("a.pcap", capture);
  const auto nearest = [&](const PcapSourceOptions& options)
  {
    float range = 1e9F;
    const auto scans = revolutionsOf(path, options).scans;
    for (const auto& point : scans.at(0).points)
    {
      range = std::min(range, point.norm());
    }
    return range;
  };
  EXPECT_NEAR(0.2F, nearest({}), 1e-3F);
  PcapSourceOptions options;
  options.min_range = 1;
  EXPECT_NEAR(10.0F, nearest(options), 1e-3F);
}

TEST(PcapSource, DropsTheBrokenFirstAndLast)
{
  const TestFolder folder;
  const std::string path = folder.write("a.pcap", captured(300, 0x22, 90));
  PcapSourceOptions options;
  options.cut_azimuth = 0;
  EXPECT_EQ(3U, revolutionsOf(path, options).scans.size());
  options.keep_partial = true;
  EXPECT_EQ(5U, revolutionsOf(path, options).scans.size());
}

TEST(PcapSource, TrustsThePaceMoreThanTheModelByte)
{
  const TestFolder folder;
  const auto result = revolutionsOf(folder.write("a.pcap", captured(200, 0x21)));
  ASSERT_FALSE(result.scans.empty());
  EXPECT_EQ("VLP16", result.scans.front().sensor_label);
  ASSERT_EQ(1U, result.warnings.size());
  EXPECT_TRUE(contains(result.warnings.front(), "taken as VLP16"));
}

TEST(PcapSource, RefusesWhatItCannotRead)
{
  const TestFolder folder;
  const auto message = [&](const std::string& path)
  { return messageOfError<UserError>([&] { revolutionsOf(path); }); };
  EXPECT_TRUE(contains(message(folder.file("none.pcap")), "no such file"));
  EXPECT_TRUE(contains(message(folder.write("a", "")), "not a network capture"));
  EXPECT_TRUE(contains(message(folder.write("b", std::string(500, 'x'))), "not a network capture"));
  EXPECT_TRUE(contains(message(folder.write("c", captured(0))), "no data packets of a Velodyne"));

  const std::string whole = captured(300);
  std::size_t frames = 0;
  const auto cut = messageOfError<UserError>(
      [&]
      {
        PcapSource source(folder.write("d", whole.substr(0, whole.size() - 700)));
        while (source.next())
        {
          ++frames;
        }
      });
  EXPECT_TRUE(contains(cut, "is cut short or damaged after 299 packets")) << cut;
  EXPECT_GE(frames, 2U);
  PcapSourceOptions options;
  options.calibration_file = folder.write("e.xml", "<nothing/>");
  EXPECT_THROW(revolutionsOf(folder.write("f", whole), options), UserError);
}

TEST(PcapSource, OwnCalibration)
{
  const TestFolder folder;
  std::string yaml = "lasers:\n";
  for (int i = 15; i >= 0; --i)
  {
    yaml += "- {dist_correction: 0.5, laser_id: " + std::to_string(i) +
            ",\n  rot_correction: 0.1, vert_correction: " + std::to_string(0.02 * i) + "}\n";
  }
  PcapSourceOptions options;
  options.calibration_file = folder.write("a.yaml", yaml + "num_lasers: 16\n");
  const std::string path = folder.write("a.pcap", captured(300));
  const auto scans = revolutionsOf(path, options).scans;
  ASSERT_FALSE(scans.empty());
  for (std::size_t i = 0; i < scans[0].size(); ++i)
  {
    const auto& p = scans[0].points[i];
    ASSERT_NEAR(10.5, p.norm(), 1e-3);
    ASSERT_NEAR(0.02 * scans[0].ring[i], std::asin(p.z() / 10.5), 1e-4);
  }
  // The other style of YAML, as in ROS's calibrations of the HDL-64E.
  std::string block = "lasers:\n";
  for (int i = 0; i < 16; ++i)
  {
    block += "- dist_correction: 0.5\n  laser_id: " + std::to_string(i) +
             "\n  rot_correction: 0.1\n  two_pt_correction_available: true\n"
             "  vert_correction: " +
             std::to_string(0.02 * i) + "\n";
  }
  options.calibration_file = folder.write("b.yaml", block + "num_lasers: 16\n");
  const auto again = revolutionsOf(path, options).scans;
  ASSERT_EQ(again.size(), scans.size());
  EXPECT_EQ(again[0].points, scans[0].points);
  options.calibration_file = folder.write("c.yaml", block + "- laser_id: 200\n");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { revolutionsOf(path, options); }),
                       "c.yaml: laser_id 200 is not an integer from 0 to 127"));
  options.calibration_file = folder.file("b.yaml");
  options.model = VelodyneModel::hdl64e;
  EXPECT_THROW(revolutionsOf(path, options), UserError);
  options.calibration_file = "";
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { revolutionsOf(path, options); }), "--calibration"));
}

TEST(PcapSource, RealCaptures)
{
  DYSLAM_REQUIRE_DATA();
  struct Expected
  {
    const char* name;
    std::size_t all, whole;
    const char* sensor;
    double period;
  };
  for (const Expected& e : {Expected{"vlp-16-test-90deg-1-50-frames", 51, 49, "VLP16", 0.05},
                            Expected{"sample_velodyne_vlp16_gps", 5, 3, "VLP16", 0.1},
                            Expected{"sample_velodyne_hdl32", 3, 1, "HDL32E", 0.1},
                            Expected{"monterey-first-100-packets", 19, 17, "HDL32E", 0.085}})
  {
    const std::string path = *realDataFolder() + "/misc_16beam_and_formats/" + e.name + ".pcap";
    EXPECT_EQ(e.sensor, PcapSource(path).sensor());
    const auto scans = revolutionsOf(path).scans;
    EXPECT_EQ(e.whole, scans.size()) << e.name;
    PcapSourceOptions options;
    options.keep_partial = true;
    EXPECT_EQ(e.all, revolutionsOf(path, options).scans.size()) << e.name;
    for (std::size_t i = 1; i < scans.size(); ++i)
    {
      EXPECT_NEAR(e.period, scans[i].stamp - scans[i - 1].stamp, 0.003) << e.name;
      EXPECT_NEAR(e.period, scans[i].time.back(), 0.003) << e.name;
    }
  }
}
}  // namespace
}  // namespace dyslam
