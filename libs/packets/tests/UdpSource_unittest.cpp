// SPDX-License-Identifier: BSD-3-Clause
// Scans of a lidar on the network, by datagrams on this computer; the system chooses the ports.
#include <dyslam/base/Error.h>
#include <dyslam/packets/PcapSource.h>
#include <dyslam/packets/UdpReceiver.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Revolutions.h"
#include "SyntheticCapture.h"
#include "SyntheticHesai.h"
#include "SyntheticOuster.h"
#include "TestFolder.h"
#include "UdpSender.h"

namespace dyslam
{
namespace
{
using test::packet_time;
using test::UdpSender;

/** A receiver on a free port. */
struct Receiving
{
  explicit Receiving(const std::string& address = "udp:127.0.0.1:0", double first_wait = 20)
  {
    UdpReceiverOptions options;
    options.first_wait = first_wait;
    options.stop = [this] { return stop.load(); };
    receiver = std::make_unique<UdpReceiver>(UdpAddress::fromText(address), options);
    ports = receiver->address().ports;
  }

  std::atomic<bool> stop = false;
  std::vector<std::uint16_t> ports;
  std::unique_ptr<UdpReceiver> receiver;
};

std::string bytesOf(const LidarPacket& packet)
{
  return {packet.bytes.begin(), packet.bytes.end()};
}

/** The datagrams that `captured(packets)` has. */
std::vector<std::string> velodynePackets(std::size_t packets)
{
  std::vector<std::string> all;
  for (std::size_t n = 0; n < packets; ++n)
  {
    all.push_back(velodynePacket(static_cast<double>(n) * packet_time));
  }
  return all;
}

/** Waits until that many were received, or for 20 s. */
void awaitReceived(const UdpReceiver& receiver, std::size_t count)
{
  for (int wait = 0; wait < 20000 && receiver.received() < count; ++wait)
  {
    ::usleep(1000);
  }
}

/** Sends datagrams no faster than they are received: the system's buffer may be small. */
void sendAll(const UdpSender& sender,
             const std::vector<std::string>& packets,
             std::uint16_t port,
             const UdpReceiver& receiver)
{
  constexpr std::size_t together = 50;
  for (std::size_t i = 0; i < packets.size(); ++i)
  {
    sender.send(packets[i], port);
    if ((i + 1) % together == 0)
    {
      awaitReceived(receiver, i + 1);
    }
  }
  awaitReceived(receiver, packets.size());
}

/** The scans of all that was received. */
std::vector<Scan> scansOf(Receiving& receiving, const PacketSourceOptions& options = {})
{
  receiving.stop = true;
  PacketSource source(std::move(receiving.receiver), options);
  std::vector<Scan> scans;
  while (auto scan = source.next())
  {
    scans.push_back(std::move(*scan));
  }
  return scans;
}

/** But for the resolution of a UNIX time. */
void expectSameScans(const std::vector<Scan>& expected, const std::vector<Scan>& scans)
{
  ASSERT_EQ(expected.size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    EXPECT_EQ(expected[i].points, scans[i].points) << i;
    EXPECT_EQ(expected[i].intensity, scans[i].intensity) << i;
    EXPECT_EQ(expected[i].ring, scans[i].ring) << i;
    ASSERT_EQ(expected[i].time.size(), scans[i].time.size());
    for (std::size_t k = 0; k < scans[i].time.size(); ++k)
    {
      ASSERT_NEAR(expected[i].time[k], scans[i].time[k], 2e-6) << i << ' ' << k;
    }
    EXPECT_NEAR(expected[i].stamp - expected[0].stamp, scans[i].stamp - scans[0].stamp, 2e-6) << i;
  }
}
}  // namespace

TEST(UdpReceiver, DeliversDatagramsInOrderWithTimesAndSenders)
{
  Receiving receiving;
  const UdpSender sender;
  const UdpSender other("127.0.0.2");
  const double before = static_cast<double>(std::time(nullptr));
  sender.send("first", receiving.ports[0]);
  other.send(std::string(20000, 'x'), receiving.ports[0]);
  sender.send("", receiving.ports[0]);
  LidarPacket packets[3];
  for (LidarPacket& packet : packets)
  {
    ASSERT_TRUE(receiving.receiver->next(packet));
    EXPECT_GE(packet.captured, before);
    EXPECT_LE(packet.captured, before + 60);
    EXPECT_EQ(receiving.ports[0], packet.stream & 0xffffU);
  }
  EXPECT_EQ("first", bytesOf(packets[0]));
  EXPECT_EQ(std::string(20000, 'x'), bytesOf(packets[1])) << "larger than a frame";
  EXPECT_EQ("", bytesOf(packets[2]));
  EXPECT_EQ(packets[0].stream, packets[2].stream);
  EXPECT_NE(packets[0].stream, packets[1].stream);
  EXPECT_TRUE(receiving.receiver->warnings().empty());
}

TEST(UdpReceiver, EndsOnRequestAfterWhatWasReceived)
{
  Receiving receiving;
  const UdpSender sender;
  sender.send("a", receiving.ports[0]);
  sender.send("b", receiving.ports[0]);
  LidarPacket packet;
  ASSERT_TRUE(receiving.receiver->next(packet));
  sender.send("c", receiving.ports[0]);
  ASSERT_TRUE(receiving.receiver->next(packet));
  ASSERT_TRUE(receiving.receiver->next(packet));
  EXPECT_EQ("c", bytesOf(packet));
  receiving.stop = true;
  EXPECT_FALSE(receiving.receiver->next(packet));
  EXPECT_FALSE(receiving.receiver->next(packet));
}

TEST(UdpReceiver, ReceivesOnSeveralPorts)
{
  Receiving receiving("udp:127.0.0.1:0,0");
  const UdpSender sender;
  ASSERT_EQ(2U, receiving.ports.size());
  sender.send("lidar", receiving.ports[0]);
  sender.send("imu", receiving.ports[1]);
  LidarPacket a;
  LidarPacket b;
  ASSERT_TRUE(receiving.receiver->next(a) && receiving.receiver->next(b));
  if (bytesOf(a) == "imu")
  {
    std::swap(a, b);
  }
  EXPECT_EQ("lidar", bytesOf(a));
  EXPECT_EQ("imu", bytesOf(b));
  EXPECT_EQ(receiving.ports[1], b.stream & 0xffffU);
  EXPECT_EQ(a.stream >> 16U, b.stream >> 16U) << "one sender";
}

TEST(UdpReceiver, SaysWhatToCheckWithoutPackets)
{
  Receiving receiving("udp:127.0.0.1:0", 0.05);
  LidarPacket packet;
  const std::string message =
      messageOfError<UserError>([&] { (void)receiving.receiver->next(packet); });
  EXPECT_TRUE(contains(message,
                       ": no packets within 0.05 s; check that the lidar is on and sends "
                       "to 127.0.0.1, UDP port " +
                           std::to_string(receiving.ports[0])))
      << message;
  EXPECT_TRUE(contains(message, "firewall")) << message;
}

/** The next one is sent once the silence was told, by the thread that waits for it. */
TEST(UdpReceiver, TellsOfASilence)
{
  const UdpSender sender;
  std::uint16_t port = 0;
  std::vector<std::string> warnings;
  UdpReceiverOptions options;
  options.silence = 0.2;
  options.warn = [&](const std::string& line)
  {
    warnings.push_back(line);
    if (warnings.size() == 1)
    {
      sender.send("b", port);
    }
  };
  UdpReceiver receiver(UdpAddress::fromText("udp:127.0.0.1:0"), options);
  port = receiver.address().ports[0];
  sender.send("a", port);
  LidarPacket packet;
  ASSERT_TRUE(receiver.next(packet));
  ASSERT_TRUE(receiver.next(packet));
  EXPECT_EQ("b", bytesOf(packet));
  ASSERT_EQ(2U, warnings.size());
  EXPECT_TRUE(contains(warnings[0], ": no packets for ")) << warnings[0];
  EXPECT_TRUE(contains(warnings[1], ": packets again, after ")) << warnings[1];
}

TEST(UdpReceiver, NamesWhyAPortCannotBeOpened)
{
  const Receiving receiving;
  const std::string port = std::to_string(receiving.ports[0]);
  const auto said = [](const std::string& address)
  {
    return messageOfError<UserError>(
        [&] { const UdpReceiver receiver(UdpAddress::fromText(address)); });
  };
  const std::string in_use = said("udp:127.0.0.1:" + port);
  EXPECT_TRUE(contains(in_use, "--input udp:127.0.0.1:" + port + ": another program receives on " +
                                   "UDP port " + port))
      << in_use;
  const std::string foreign = said("udp:192.0.2.1:0");  // of a network for documentation
  EXPECT_TRUE(contains(foreign, "192.0.2.1 is no address of this computer")) << foreign;
}

TEST(UdpSource, GivesTheScansOfACaptureOfAVelodyne)
{
  const TestFolder folder;
  constexpr std::size_t packets = 600;  // almost eight revolutions
  const auto expected = test::revolutionsOf(folder.write("a.pcap", captured(packets))).scans;
  ASSERT_LT(5U, expected.size());
  Receiving receiving;
  const UdpSender sender;
  sendAll(sender, velodynePackets(packets), receiving.ports[0], *receiving.receiver);
  const auto scans = scansOf(receiving);
  expectSameScans(expected, scans);
  EXPECT_NEAR(static_cast<double>(std::time(nullptr)), scans.at(0).stamp, 60) << "received now";
}

TEST(UdpSource, GivesTheScansOfACaptureOfAHesai)
{
  const TestFolder folder;
  SyntheticHesai lidar;
  std::vector<std::string> packets;
  std::string capture = captureHeader();
  for (std::size_t n = 0; n < 900; ++n)
  {
    packets.push_back(lidar.packet(n));
    appendFrame(capture, lidar.clock_zero + 1e-3 * static_cast<double>(n),
                ipFrame(udpDatagram(packets.back(), 2368), 0, 0));
  }
  const auto expected = test::revolutionsOf(folder.write("a.pcap", capture)).scans;
  ASSERT_LT(1U, expected.size());
  Receiving receiving;
  const UdpSender sender;
  sendAll(sender, packets, receiving.ports[0], *receiving.receiver);
  expectSameScans(expected, scansOf(receiving));
}

TEST(UdpSource, GivesTheScansAndTheImuOfAnOuster)
{
  const TestFolder folder;
  const SyntheticOuster lidar;
  PacketSourceOptions options;
  options.calibration_file = folder.write("os.json", lidar.metadata());
  options.imu = true;
  const std::vector<std::string> packets = lidar.packetsOf(6);
  const auto expected =
      test::revolutionsOf(folder.write("a.pcap", SyntheticOuster::capture(packets)), options).scans;
  ASSERT_LT(3U, expected.size());
  Receiving receiving("udp:127.0.0.1:0,0");
  const UdpSender sender;
  sendAll(sender, packets, receiving.ports[0], *receiving.receiver);
  sender.send(SyntheticOuster::imuPacket(lidar.first_time), receiving.ports[1]);
  awaitReceived(*receiving.receiver, packets.size() + 1);
  receiving.stop = true;
  PacketSource source(std::move(receiving.receiver), options);
  std::vector<Scan> scans;
  while (auto scan = source.next())
  {
    scans.push_back(std::move(*scan));
  }
  expectSameScans(expected, scans);
  EXPECT_EQ(1U, source.imuPackets());
  EXPECT_EQ(1U, source.takeImu().size());
}

TEST(UdpSource, OtherSendersAreLeftOut)
{
  Receiving receiving;
  const UdpSender sender;
  const UdpSender other("127.0.0.2");
  sendAll(sender, velodynePackets(300), receiving.ports[0], *receiving.receiver);
  other.send(velodynePacket(3), receiving.ports[0]);
  awaitReceived(*receiving.receiver, 301);
  receiving.stop = true;
  PacketSource source(std::move(receiving.receiver));
  while (source.next())
  {
  }
  EXPECT_TRUE(hasLine(source.warnings(),
                      "1 packets of other senders or ports left out; set another "
                      "port in each lidar"))
      << source.warnings().size();
}

TEST(UdpSource, OtherPacketsAreAnError)
{
  Receiving receiving;
  const UdpSender sender;
  sendAll(sender, std::vector<std::string>(300, std::string(1000, 'x')), receiving.ports[0],
          *receiving.receiver);
  receiving.stop = true;
  const std::string port = std::to_string(receiving.ports[0]);
  const std::string message =
      messageOfError<UserError>([&] { const PacketSource source(std::move(receiving.receiver)); });
  EXPECT_EQ("udp:127.0.0.1:" + port +
                ": has no data packets of a Velodyne (UDP, 1206 bytes) or a "
                "Hesai, but UDP packets of 1000 bytes (port " +
                port +
                "); of an Ouster, name its "
                "metadata (.json) with --calibration",
            message);
}
}  // namespace dyslam
