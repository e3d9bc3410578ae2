// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/HesaiPackets.h>
#include <dyslam/packets/HesaiScans.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
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

/** Whether the points of each ring are in the order of their times. */
bool ringsAreInOrder(const Scan& scan)
{
  std::map<std::uint16_t, float> latest;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
  {
    const auto [last, is_first] = latest.emplace(scan.ring[i], scan.time[i]);
    if (!is_first && scan.time[i] < last->second)
    {
      return false;
    }
    last->second = scan.time[i];
  }
  return true;
}

double degrees(double radians)
{
  return radians * 180 / M_PI;
}

/** Largest deviation of the points' azimuths, without those of their lasers, from the angle of the
 * rotor at the times of the points [deg]. The first firing is left out: the direction of rotation
 * is not known yet. */
double azimuthError(const SyntheticHesai& lidar,
                    const std::vector<Scan>& scans,
                    const HesaiAngles& angles)
{
  const auto rings = ringsByElevation(angles.elevations);
  std::vector<double> azimuths(rings.size());
  for (std::size_t laser = 0; laser < rings.size(); ++laser)
  {
    azimuths[rings[laser]] = degrees(angles.azimuths[laser]);
  }
  double largest = 0;
  for (const Scan& scan : scans)
  {
    for (std::size_t i = 0; i < scan.points.size(); ++i)
    {
      const double time = scan.stamp + static_cast<double>(scan.time[i]) - lidar.clock_zero;
      if (time > lidar.shape().period)
      {
        const Eigen::Vector3d p = scan.points[i].cast<double>();
        const double rotor =
            lidar.first_azimuth + (lidar.clockwise ? 360 : -360) * time / SyntheticHesai::turn;
        const double azimuth = degrees(std::atan2(p.x(), p.y())) - azimuths[scan.ring[i]];
        largest = std::max(largest, std::abs(std::remainder(azimuth - rotor, 360)));
      }
    }
  }
  return largest;
}

/** Scans of some time [s] by the sensor's own clock. */
std::vector<Scan> scansByClock(const SyntheticHesai& lidar,
                               double duration,
                               HesaiScansOptions options = {})
{
  options.keep_partial = true;
  HesaiScans scans("x", options);
  std::vector<Scan> all;
  for (std::size_t n = 0; static_cast<double>(n) * lidar.packetTime() < duration; ++n)
  {
    const double time = static_cast<double>(n) * lidar.packetTime();
    scans.add(received(lidar.packet(n), lidar.clock_zero + time + 0.01));
  }
  scans.finish();
  while (auto scan = scans.take())
  {
    all.push_back(std::move(*scan));
  }
  return all;
}

/** Channel,elevation,azimuth. \param step of each below the one before [deg] */
std::string angleFile(std::size_t lasers, double step = 1)
{
  std::string text = "Laser id,Elevation,Azimuth\r\n";
  for (std::size_t i = 0; i < lasers; ++i)
  {
    text += std::to_string(i + 1) + "," + std::to_string(20 - step * static_cast<double>(i)) +
            ",2.5\r\n";
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
      EXPECT_TRUE(ringsAreInOrder(scan));
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
  // Azimuth 0 is y; the beam turns to the right, which is x, from shot to shot and from firing to
  // firing.
  const double shot = 0.368e-6 + 15 * 1.512e-6;
  const double turned = 2 * M_PI * shot / SyntheticHesai::turn;
  EXPECT_TRUE(scan.points[14].isApprox(
      Eigen::Vector3d(12 * std::sin(turned), 12 * std::cos(turned), 0).cast<float>(), 1e-5F));
  EXPECT_NEAR(scan.points[0].z(), 12 * std::sin(15 * M_PI / 180), 1e-4);
  EXPECT_EQ(scan.ring[0], 31);
  EXPECT_EQ(scan.ring[14], 16);
  EXPECT_NEAR(scan.points[seen + 14].x(), 12 * std::sin(0.18 * M_PI / 180 + turned), 1e-4);
  EXPECT_NEAR(scan.time[14], shot, 1e-9);
  EXPECT_NEAR(scan.time[seen + 14], 50e-6 + shot, 1e-8);
}

TEST(HesaiScans, APointHasTheRotorsAngleAtItsTime)
{
  // A step of the rotor is rounded to 0.01 deg, the clock to 1 us.
  constexpr double rounding = 0.015;
  for (const HesaiKind kind : designed)
  {
    for (const bool clockwise : {true, false})
    {
      SyntheticHesai lidar;
      lidar.kind = kind;
      lidar.clockwise = clockwise;
      const auto scans = scansByClock(lidar, 0.02);
      const auto angles = designedHesaiAngles(*hesaiLayoutOf(received(lidar.packet(0))));
      ASSERT_TRUE(angles);
      EXPECT_LT(azimuthError(lidar, scans, *angles), rounding) << static_cast<int>(kind);
    }
  }
}

TEST(HesaiScans, AnOvertakenPacketDoesNotReverseTheRotor)
{
  SyntheticHesai lidar;
  lidar.kind = HesaiKind::qt64;
  const auto sortedX = [&lidar](const std::vector<std::size_t>& order)
  {
    HesaiScansOptions options;
    options.keep_partial = true;
    HesaiScans scans("lidar.pcap", options);
    for (const std::size_t n : order)
    {
      scans.add(received(lidar.packet(n), 2000 + static_cast<double>(n) * lidar.packetTime()));
    }
    scans.finish();
    std::vector<float> xs;
    while (const auto scan = scans.take())
    {
      for (const Eigen::Vector3f& point : scan->points)
      {
        xs.push_back(point.x());
      }
    }
    std::sort(xs.begin(), xs.end());
    return xs;
  };
  EXPECT_EQ(sortedX({0, 1, 2, 3, 4, 5, 6, 7}), sortedX({0, 1, 2, 4, 3, 5, 6, 7}));
}

TEST(HesaiScans, LasersShootAtTheirOwnTimes)
{
  const auto shotsOf = [](HesaiKind kind, bool second)
  {
    SyntheticHesai lidar;
    lidar.kind = kind;
    return hesaiShots(*hesaiLayoutOf(received(lidar.packet(0))), second);
  };
  constexpr double tolerance = 0.03e-6;
  EXPECT_NEAR(shotsOf(HesaiKind::pandar40, false)[7], 55.56e-6 - 54.67e-6, tolerance);
  EXPECT_NEAR(shotsOf(HesaiKind::pandar40, false)[3], 55.56e-6 - 3.62e-6, tolerance);
  EXPECT_NEAR(shotsOf(HesaiKind::pandar64, false)[4], 55.56e-6 - 17.964e-6, tolerance);
  EXPECT_NEAR(shotsOf(HesaiKind::xt16, false)[15], 45.728e-6, tolerance);
  EXPECT_NEAR(shotsOf(HesaiKind::xt32m2x, false)[31], 43.688e-6, tolerance);
  EXPECT_NEAR(shotsOf(HesaiKind::qt64, false)[8], 29.16e-6, tolerance);
  EXPECT_NEAR(shotsOf(HesaiKind::qt64, false)[63], 146.45e-6, tolerance);
  // Channels 99, 65 and 35, or 65, 99 and 1 are the first three of a QT128.
  const auto first = shotsOf(HesaiKind::qt128, false);
  EXPECT_NEAR(first[98], 0.6e-6, tolerance);
  EXPECT_NEAR(first[64], 1.456e-6, tolerance);
  EXPECT_NEAR(first[34], 2.312e-6, tolerance);
  EXPECT_NEAR(first[60], 100.52e-6, tolerance);
  const auto second = shotsOf(HesaiKind::qt128, true);
  EXPECT_NEAR(second[64], 0.6e-6, tolerance);
  EXPECT_NEAR(second[98], 1.456e-6, tolerance);
  EXPECT_NEAR(second[0], 2.312e-6, tolerance);
  EXPECT_NEAR(second[30], 100.52e-6, tolerance);
  EXPECT_EQ(shotsOf(HesaiKind::ot128, false), std::vector<double>(128, 0));
}

TEST(HesaiScans, TheSequencesOfAQt128Alternate)
{
  const TestFolder folder;
  std::ofstream(folder.file("qt.csv")) << angleFile(128, 0.5);
  HesaiScansOptions options;
  options.angle_file = folder.file("qt.csv");
  const HesaiAngles angles = readHesaiAngles(options.angle_file, 128);
  for (const bool dual : {false, true})
  {
    SyntheticHesai lidar;
    lidar.kind = HesaiKind::qt128;
    lidar.dual = dual;
    const auto scans = scansByClock(lidar, 0.01, options);
    ASSERT_EQ(scans.size(), 1U);
    EXPECT_LT(azimuthError(lidar, scans, angles), 0.015);
    // Channels 1 and 35, which shoot 2.312 us after the begin of every other firing.
    const auto shootsAt = [&scan = scans[0]](std::uint16_t ring)
    {
      const auto at = std::find(scan.ring.begin(), scan.ring.end(), ring) - scan.ring.begin();
      return scan.time[static_cast<std::size_t>(at)];
    };
    EXPECT_NEAR(shootsAt(127), 2.312e-6, 1e-8);
    EXPECT_NEAR(shootsAt(127 - 34), 111.11e-6 + 2.312e-6, 1e-6);
  }
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
  for (const HesaiKind kind :
       {HesaiKind::qt128, HesaiKind::pandar128, HesaiKind::ot128, HesaiKind::jt128})
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
    const double shot = kind == HesaiKind::qt128 ? 2.312e-6 : 0;
    EXPECT_NEAR(degrees(std::atan2(first.x(), first.y())), 2.5 + 3600 * shot, 1e-3);
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

TEST(HesaiScans, TheSeriesOfThePandar128AreToldApart)
{
  const TestFolder folder;
  std::ofstream(folder.file("own.csv")) << angleFile(128);
  HesaiScansOptions options;
  options.angle_file = folder.file("own.csv");
  struct Expected
  {
    HesaiKind kind;
    bool fine;
    const char* name;
    double period;
  };
  for (const auto& [kind, fine, name, period] :
       {Expected{HesaiKind::pandar128, false, "Pandar128", 55.556e-6},
        Expected{HesaiKind::pandar128, true, "Pandar128", 27.778e-6},
        Expected{HesaiKind::ot128, false, "OT128", 55.556e-6},
        Expected{HesaiKind::ot128, true, "OT128", 27.778e-6},
        Expected{HesaiKind::jt128, false, "JT128", 111e-6}})
  {
    SyntheticHesai lidar;
    lidar.kind = kind;
    lidar.fine = fine;
    const auto scans = scansByClock(lidar, 0.01, options);
    ASSERT_EQ(scans.size(), 1U);
    EXPECT_EQ(scans[0].sensor_label, name);
    EXPECT_NEAR(scans[0].stamp, lidar.clock_zero, 1e-6) << name;
    constexpr std::size_t seen = 127;
    EXPECT_NEAR(scans[0].time[seen], period, 1e-6) << name;
    EXPECT_NEAR(scans[0].points[seen].norm(), 12, 1e-3) << name;
    EXPECT_FLOAT_EQ(scans[0].intensity[seen], 0x33 / 255.0F) << name;
  }
  // The same packets of other numbers of lasers are not those of the Pandar40P and 64.
  SyntheticHesai lidar;
  lidar.kind = HesaiKind::pandar128;
  std::string packet = lidar.packet(0);
  packet[6] = 64;
  EXPECT_EQ(hesaiLayoutOf(received(packet))->name, "Pandar64E3X");
}

TEST(HesaiScans, AQt128MayHaveTheConfidenceWithoutItsFlag)
{
  SyntheticHesai lidar;
  lidar.kind = HesaiKind::qt128;
  std::string packet = lidar.packet(0);
  const auto flagged = hesaiLayoutOf(received(packet));
  packet[11] = '\x05';
  const auto layout = hesaiLayoutOf(received(packet));
  ASSERT_TRUE(flagged && layout);
  EXPECT_EQ(layout->return_bytes, 4U);
  EXPECT_EQ(layout->packet_bytes, flagged->packet_bytes);
  constexpr std::size_t confidences = 2 * 128;
  const auto without = hesaiLayoutOf(received(packet.substr(0, packet.size() - confidences)));
  ASSERT_TRUE(without);
  EXPECT_EQ(without->return_bytes, 3U);
}

TEST(HesaiScans, SelectedChannelsAreAnError)
{
  SyntheticHesai lidar;
  lidar.kind = HesaiKind::qt128;
  std::string packet = lidar.packet(0);
  packet[11] = static_cast<char>(packet[11] | 0x40);
  HesaiScans scans("a.pcap", {});
  const std::string message = messageOfError<UserError>([&] { scans.add(received(packet)); });
  EXPECT_NE(message.find("a.pcap: this Hesai sends selected channels only"), std::string::npos);
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

TEST(HesaiScans, PacketsThatAreNotDecodedAreNamed)
{
  const SyntheticHesai lidar;
  std::string packet = lidar.packet(0);
  EXPECT_FALSE(whyNoHesaiScans(received(packet)));
  EXPECT_FALSE(whyNoHesaiScans(received(std::string(1206, '\x20'))));
  EXPECT_FALSE(whyNoHesaiScans(received("")));
  packet.replace(2, 2, "\x04\x03");
  EXPECT_NE(whyNoHesaiScans(received(packet)).value_or("").find("Hesai AT128"), std::string::npos);
  const TestFolder folder;
  std::string capture = captureHeader();
  appendFrame(capture, 1000, ipFrame(udpDatagram(packet, 2368), 0, 0));
  std::ofstream(folder.file("at.pcap"), std::ios::binary) << capture;
  const std::string message =
      messageOfError<UserError>([&] { PcapSource source(folder.file("at.pcap")); });
  EXPECT_NE(message.find("at.pcap: has UDP packets of a Hesai AT128, which are not decoded"),
            std::string::npos)
      << message;
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
