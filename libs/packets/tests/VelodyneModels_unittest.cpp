// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/packets/PcapSource.h>
#include <dyslam/packets/VelodyneModels.h>
#include <dyslam/packets/VelodynePackets.h>
#include <dyslam/packets/VelodyneScans.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "SyntheticCapture.h"

namespace dyslam
{
namespace
{
constexpr double degree = M_PI / 180;

/** A packet with one return of each laser in its first firing, at 5000 units.
 * \param azimuth of the first firing; one firing turns on by 0.2 deg. */
std::string packetOf(VelodyneModel model,
                     double azimuth,
                     std::uint8_t model_byte,
                     bool dual = false)
{
  const std::size_t lasers = traitsOf(model).lasers;
  const std::size_t blocks = std::max<std::size_t>(1, lasers / 32) * (dual ? 2 : 1);
  const std::array<std::uint16_t, 4> banks{0xeeff, 0xddff, 0xccff, 0xbbff};
  std::string bytes;
  for (std::size_t block = 0; block < 12; ++block)
  {
    const std::size_t firing = block / blocks;
    const std::size_t bank = block % blocks / (dual ? 2 : 1);
    // In dual mode a packet of a VLS-128 has one firing and four empty blocks.
    const bool empty = dual && lasers == 128 && firing > 0;
    appendBytes<std::uint16_t>(bytes, empty ? 0 : banks.at(bank));
    const double turned = 100 * azimuth + 20.0 * static_cast<double>(firing);
    appendBytes(bytes, static_cast<std::uint16_t>(empty ? 0 : std::lround(turned)));
    for (std::size_t k = 0; k < 32; ++k)
    {
      const std::uint16_t range = firing > 0 || k >= lasers ? 0
                                  : dual && block % 2 == 1  ? 6000
                                                            : 5000;
      appendBytes(bytes, range);
      bytes += static_cast<char>(51);
    }
  }
  appendBytes<std::uint32_t>(bytes, 1000);
  bytes += static_cast<char>(dual ? 0x39 : 0x37);
  bytes += static_cast<char>(model_byte);
  return bytes;
}

Scan decoded(VelodyneModel model, const std::string& bytes)
{
  const VelodyneDecoder decoder(model, usualCalibration(model), 0, 300);
  const VelodynePacketView view{reinterpret_cast<const std::uint8_t*>(bytes.data())};
  Scan scan;
  for (std::size_t block = 0; block < velodyne_blocks; ++block)
  {
    EXPECT_TRUE(decoder.decodeBlock(view, block, 0, scan));
  }
  return scan;
}

double elevation(const Eigen::Vector3f& point)
{
  return std::asin(point.z() / point.norm()) / degree;
}

/** Clockwise from ahead [deg]. */
double azimuth(const Eigen::Vector3f& point)
{
  return std::atan2(-point.y(), point.x()) / degree;
}
}  // namespace

TEST(VelodyneModels, NamesAndBytes)
{
  EXPECT_EQ(VelodyneModel::vlp32c, velodyneModelNamed("VLP-32C"));
  EXPECT_EQ(VelodyneModel::vls128, velodyneModelNamed("VLS128"));
  EXPECT_EQ(VelodyneModel::automatic, velodyneModelNamed(""));
  EXPECT_FALSE(velodyneModelNamed("OS1"));
  EXPECT_EQ("VLP16, VLP16HR, HDL32E, HDL64E, VLP32C or VLS128", velodyneModelNames());
  EXPECT_EQ(VelodyneModel::hdl64e, givenVelodyneModel("HDL-64E"));
  EXPECT_THROW((void)givenVelodyneModel("OS1"), UserError);
  EXPECT_EQ(VelodyneModel::hdl32e, velodyneModelOf(32, 0x21));
  EXPECT_EQ(VelodyneModel::vlp32c, velodyneModelOf(32, 0x28));
  EXPECT_EQ(VelodyneModel::hdl64e, velodyneModelOf(64, 0x28)) << "the number of lasers counts";
  EXPECT_FALSE(velodyneModelOf(17, 0x22));
}

TEST(VelodyneModels, OptionsKeepEachModel)
{
  for (const VelodyneModel model :
       {VelodyneModel::automatic, VelodyneModel::vlp16, VelodyneModel::vlp16_hires,
        VelodyneModel::hdl32e, VelodyneModel::hdl64e, VelodyneModel::vlp32c, VelodyneModel::vls128})
  {
    PcapSourceOptions written;
    written.model = model;
    Config config;
    save(written, config, "pcap");
    PcapSourceOptions read;
    load(read, config, "pcap");
    EXPECT_EQ(model, read.model);
  }
}

TEST(VelodyneModels, PointsOfAVlp32c)
{
  const Scan scan = decoded(VelodyneModel::vlp32c, packetOf(VelodyneModel::vlp32c, 90, 0x28));
  ASSERT_EQ(32U, scan.size());
  const double turned = 0.2 * 2.304 / 55.296;  // from one shot to the next [deg]
  struct Expected
  {
    std::size_t laser;
    double elevation, azimuth;
    std::size_t shot;
    std::uint16_t ring;
  };
  // The rows of the manual's table of channels: the lowest, the highest, and the third.
  for (const Expected& e : {Expected{0, -25, 91.4, 0, 0}, Expected{29, 15, 88.6, 14, 31},
                            Expected{3, -15.639, 88.6, 1, 1}})
  {
    EXPECT_NEAR(20, scan.points[e.laser].norm(), 1e-4);
    EXPECT_NEAR(e.elevation, elevation(scan.points[e.laser]), 1e-3) << e.laser;
    EXPECT_NEAR(e.azimuth + static_cast<double>(e.shot) * turned, azimuth(scan.points[e.laser]),
                1e-3)
        << e.laser;
    EXPECT_NEAR(static_cast<double>(e.shot) * 2.304e-6, scan.time[e.laser], 1e-9);
    EXPECT_EQ(e.ring, scan.ring[e.laser]);
  }
}

TEST(VelodyneModels, PointsOfAVls128)
{
  const Scan scan = decoded(VelodyneModel::vls128, packetOf(VelodyneModel::vls128, 10, 0xA1));
  ASSERT_EQ(128U, scan.size());
  const double turned = 0.2 * 2.665 / 53.3;
  // Channels 1, 37, 60 and 128 of the manual's table; after 64 lasers it pauses for a shot.
  struct Expected
  {
    std::size_t laser;
    double elevation, azimuth;
    std::size_t shot;
  };
  for (const Expected& e : {Expected{0, -11.742, 16.354, 0}, Expected{36, -25, 9.089, 4},
                            Expected{59, 15, 10.911, 7}, Expected{127, 0.43, 3.646, 16}})
  {
    EXPECT_NEAR(e.elevation, elevation(scan.points[e.laser]), 1e-3) << e.laser;
    EXPECT_NEAR(e.azimuth + static_cast<double>(e.shot) * turned, azimuth(scan.points[e.laser]),
                1e-3)
        << e.laser;
    EXPECT_NEAR(static_cast<double>(e.shot) * 2.665e-6, scan.time[e.laser], 1e-9);
  }
  EXPECT_EQ(0, scan.ring[36]);
  EXPECT_EQ(127, scan.ring[59]);
  const Scan dual = decoded(VelodyneModel::vls128, packetOf(VelodyneModel::vls128, 10, 0xA1, true));
  ASSERT_EQ(256U, dual.size());
  for (std::size_t i = 0; i < dual.size(); ++i)
  {
    EXPECT_NEAR(10, azimuth(dual.points[i]), 7) << "the empty blocks count for nothing";
  }
}

TEST(VelodyneModels, TurnsOfAVls128WithDualReturns)
{
  VelodyneScans scans("x", {});
  for (int firing = 0; firing < 3 * 1800; ++firing)
  {
    const std::string bytes =
        packetOf(VelodyneModel::vls128, std::fmod(0.2 * firing, 360), 0xA1, true);
    scans.add({{bytes.begin(), bytes.end()}, 0, 0});
  }
  scans.finish();
  std::size_t turns = 0;
  while (const auto scan = scans.take())
  {
    EXPECT_EQ(1800U * 256U, scan->size());
    ++turns;
  }
  EXPECT_EQ(2U, turns) << "of three that begin ahead and are cut behind";
  EXPECT_TRUE(scans.warnings().empty());
}

/** Its blocks are lower and upper bank of the first return, then both of the second. */
TEST(VelodyneModels, DualReturnsOfAnHdl64e)
{
  std::string bytes;
  for (std::size_t block = 0; block < 12; ++block)
  {
    appendBytes<std::uint16_t>(bytes, block % 2 == 0 ? 0xeeff : 0xddff);
    appendBytes(bytes, static_cast<std::uint16_t>(9000 + 17 * (block / 4)));
    for (std::size_t k = 0; k < 32; ++k)
    {
      // Every other laser has two different returns.
      appendBytes<std::uint16_t>(bytes, block % 4 >= 2 && k % 2 == 1 ? 6000 : 5000);
      bytes += static_cast<char>(51);
    }
  }
  appendBytes<std::uint32_t>(bytes, 1000);
  bytes += "H7";  // a status, no mode
  mrpt::obs::VelodyneCalibration calibration;
  calibration.laser_corrections.resize(64, {});
  constexpr std::array<std::size_t, 4> points{32, 64, 80, 96};  // up to each block of a firing
  const VelodyneDecoder decoder(VelodyneModel::hdl64e, calibration, 0, 300);
  const VelodynePacketView view{reinterpret_cast<const std::uint8_t*>(bytes.data())};
  Scan scan;
  for (std::size_t block = 0; block < velodyne_blocks; ++block)
  {
    EXPECT_TRUE(decoder.decodeBlock(view, block, 0, scan));
    EXPECT_EQ(block / 4 * 96 + points.at(block % 4), scan.size());
    EXPECT_NEAR(48e-6 * static_cast<double>(block / 4) + 31 * 1.5e-6, scan.time.back(), 1e-9);
  }
}

TEST(VelodyneModels, TheByteOfThePacketsIsRecognised)
{
  struct Case
  {
    VelodyneModel model;
    std::uint8_t byte;
  };
  for (const Case& c : {Case{VelodyneModel::vls128, 0xA1}, Case{VelodyneModel::vlp32c, 0x28},
                        Case{VelodyneModel::vlp16_hires, 0x24}})
  {
    VelodyneScansOptions options;
    options.keep_partial = true;
    VelodyneScans scans("x", options);
    const std::string bytes = packetOf(c.model, 10, c.byte);
    scans.add({{bytes.begin(), bytes.end()}, 0, 0});
    scans.finish();
    EXPECT_EQ(c.model, scans.model());
    const auto scan = scans.take();
    ASSERT_TRUE(scan);
    EXPECT_EQ(traitsOf(c.model).name, scan->sensor_label);
    EXPECT_EQ(traitsOf(c.model).lasers, scan->size());
  }
}
}  // namespace dyslam
