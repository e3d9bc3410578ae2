// SPDX-License-Identifier: BSD-3-Clause
// Data packets in the frames of a network capture: tags, IPv6, fragments, copies, several senders.
#include <dyslam/base/Error.h>
#include <dyslam/packets/PcapSource.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
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

/** A block of a .pcapng. */
std::string ngBlock(std::uint32_t type, std::string body)
{
  body.resize((body.size() + 3) / 4 * 4);
  std::string block;
  appendBytes(block, type);
  appendBytes(block, static_cast<std::uint32_t>(body.size() + 12));
  block += body;
  appendBytes(block, static_cast<std::uint32_t>(body.size() + 12));
  return block;
}

/** A .pcapng of two interfaces, of which one is Ethernet and has the frames of a lidar. */
std::string capturedOnTwoInterfaces(std::uint32_t ethernet)
{
  std::string section("\x4D\x3C\x2B\x1A\x01\0\0\0", 8);
  std::string file = ngBlock(0x0A0D0D0A, section + std::string(8, '\xFF'));
  for (std::uint32_t i = 0; i < 2; ++i)
  {
    const std::string link = i == ethernet ? "\x01" : "\x71";  // the other one: cooked
    file += ngBlock(1, link + std::string(7, '\0'));
  }
  for (std::size_t n = 0; n < 600; ++n)
  {
    const double time = static_cast<double>(n / 2) * packet_time;
    const std::string frame = ipFrame(udpDatagram(velodynePacket(time), 2368), 0, 0);
    std::string packet;
    appendBytes(packet, n % 2 == 0 ? ethernet : 1 - ethernet);
    appendBytes<std::uint32_t>(packet, 0);
    appendBytes(packet, static_cast<std::uint32_t>(1e6 * time));
    appendBytes(packet, static_cast<std::uint32_t>(frame.size()));
    appendBytes(packet, static_cast<std::uint32_t>(frame.size()));
    file += ngBlock(6, packet + frame);
  }
  return file;
}

TEST(PcapFrames, PacketsThatWereCapturedTwice)
{
  const TestFolder folder;
  std::string twice = captureHeader();
  for (std::size_t n = 0; n < 300; ++n)
  {
    const double time = static_cast<double>(n) * packet_time;
    const std::string frame = ipFrame(udpDatagram(velodynePacket(time), 2368), 0, 0);
    appendFrame(twice, 1000 + time, frame);
    appendFrame(twice, 1000 + time, frame);
  }
  const auto once = revolutionsOf(folder.write("a.pcap", captured(300)));
  const auto read = revolutionsOf(folder.write("b.pcap", twice));
  ASSERT_EQ(once.scans.size(), read.scans.size());
  for (std::size_t i = 0; i < once.scans.size(); ++i)
  {
    EXPECT_EQ(once.scans[i].size(), read.scans[i].size());
  }
  EXPECT_TRUE(once.warnings.empty());
  ASSERT_EQ(1U, read.warnings.size());
  EXPECT_TRUE(contains(read.warnings[0], "b.pcap: 300 packets received twice"));
}

TEST(PcapFrames, VlanTagsAreSkipped)
{
  struct Kind
  {
    char link;              //!< type of the capture's frames
    std::size_t addresses;  //!< what stands before the types [bytes]
    std::string tags;
  };
  const std::string tag("\x81\x00\x00\x05", 4);
  const std::string outer("\x88\xa8\x00\x01", 4);
  const TestFolder folder;
  // Ethernet (1) with one and two tags, and the cooked frames of `tcpdump -i any` (113).
  for (const Kind& kind :
       {Kind{1, 12, tag}, Kind{1, 12, outer + tag}, Kind{113, 14, ""}, Kind{113, 14, tag}})
  {
    std::string file = captureHeader();
    file[20] = kind.link;
    for (std::size_t n = 0; n < 300; ++n)
    {
      const double time = static_cast<double>(n) * packet_time;
      const std::string frame = ipFrame(udpDatagram(velodynePacket(time), 2368), 0, 0);
      appendFrame(file, 1000 + time,
                  std::string(kind.addresses, '\0') + kind.tags + frame.substr(12));
    }
    EXPECT_EQ(3U, revolutionsOf(folder.write("a.pcap", file)).scans.size())
        << static_cast<int>(kind.link) << ", " << kind.tags.size();
  }
}

TEST(PcapFrames, InterfacesOfSeveralKinds)
{
  const TestFolder folder;
  const auto read = revolutionsOf(folder.write("a.pcapng", capturedOnTwoInterfaces(0)));
  EXPECT_EQ(3U, read.scans.size());
  ASSERT_EQ(1U, read.warnings.size());
  EXPECT_TRUE(contains(read.warnings[0], "interfaces of another kind or snapshot length"));
  const std::string other = folder.write("b.pcapng", capturedOnTwoInterfaces(1));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { revolutionsOf(other); }),
                       "interfaces of another kind or snapshot length"));
}

TEST(PcapFrames, FramesThatWereCut)
{
  constexpr std::size_t snapshot = 200;  // [bytes]
  const std::string frame = ipFrame(udpDatagram(velodynePacket(0), 2368), 0, 0);
  std::string file = captureHeader();
  appendBytes<std::uint64_t>(file, 1000);
  appendBytes(file, static_cast<std::uint32_t>(snapshot));
  appendBytes(file, static_cast<std::uint32_t>(frame.size()));
  file += frame.substr(0, snapshot);
  const TestFolder folder;
  const std::string path = folder.write("cut.pcap", file);
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { PcapSource source(path); }),
                       "frames were cut at capture (tcpdump -s 0 keeps them whole)"));
}

TEST(PcapFrames, PacketsOverIpv6)
{
  constexpr char udp = 17;
  constexpr char destination_options = 60;
  constexpr char fragment = 44;
  const TestFolder folder;
  const auto framesOf = [](std::size_t kind, const std::string& datagram, char number)
  {
    const std::string options("\x11\0\1\4\0\0\0\0", 8);  // before UDP, padded
    switch (kind)
    {
      case 0:
        return std::vector{ip6Frame(datagram, udp), ip6Frame(datagram.substr(0, 900), udp, 2)};
      case 1:
        return std::vector{ip6Frame(options + datagram, destination_options) + "filled up"};
      default:
        const std::string header("\x11\0", 2);
        const std::string id = std::string("\0\1\0", 3) + number;
        return std::vector{
            ip6Frame(header + std::string("\2\0", 2) + id + datagram.substr(512), fragment),
            ip6Frame(header + std::string("\0\1", 2) + id + datagram.substr(0, 512), fragment)};
    }
  };
  const auto expected = revolutionsOf(folder.write("a.pcap", captured(300)));
  for (std::size_t kind = 0; kind < 3; ++kind)
  {
    std::string file = captureHeader();
    for (std::size_t n = 0; n < 300; ++n)
    {
      const double time = static_cast<double>(n) * packet_time;
      const std::string datagram = udpDatagram(velodynePacket(time), 2368);
      for (std::string frame : framesOf(kind, datagram, static_cast<char>(n)))
      {
        frame.insert(12, std::string("\x81\x00\x00\x05", 4));
        appendFrame(file, 1000 + time, frame);
      }
    }
    const auto read = revolutionsOf(folder.write("b.pcap", file));
    ASSERT_EQ(expected.scans.size(), read.scans.size()) << kind;
    EXPECT_EQ(expected.scans.back().points, read.scans.back().points) << kind;
    EXPECT_TRUE(read.warnings.empty()) << kind;
  }
}

TEST(PcapFrames, TwoLidarsOverIpv6)
{
  const TestFolder folder;
  std::string file = captureHeader();
  for (std::size_t n = 0; n < 300; ++n)
  {
    const double time = static_cast<double>(n) * packet_time;
    for (const char sender : {'\1', '\2'})
    {
      const std::string datagram = udpDatagram(velodynePacket(time), 2368);
      appendFrame(file, 1000 + time, ip6Frame(datagram, 17, sender));
    }
  }
  const auto read = revolutionsOf(folder.write("a.pcap", file));
  EXPECT_EQ(3U, read.scans.size());
  ASSERT_EQ(1U, read.warnings.size());
  EXPECT_TRUE(contains(read.warnings[0], "300 packets of other senders"));
  EXPECT_TRUE(contains(read.warnings[0], "tcpdump -r " + folder.file("a.pcap") + " -w one.pcap"));
}

TEST(PcapFrames, ADatagramWithAHoleIsNone)
{
  const TestFolder folder;
  std::string file = captureHeader();
  for (std::size_t n = 0; n < 300; ++n)
  {
    const double time = static_cast<double>(n) * packet_time;
    auto frames = fragmentsOf(udpDatagram(velodynePacket(time), 2368), n, 512);
    if (n == 150)
    {
      frames[1] = frames[0];  // one was lost, another received twice
    }
    for (const std::string& frame : frames)
    {
      appendFrame(file, 1000 + time, frame);
    }
  }
  PcapSourceOptions options;
  options.keep_partial = true;
  const auto points = [&options](const std::string& path)
  {
    std::size_t sum = 0;
    for (const Scan& scan : revolutionsOf(path, options).scans)
    {
      sum += scan.size();
    }
    return sum;
  };
  EXPECT_EQ(points(folder.write("whole.pcap", captured(300))) - 12 * 30,
            points(folder.write("cut.pcap", file)));
}
}  // namespace
}  // namespace dyslam
