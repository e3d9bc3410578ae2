// SPDX-License-Identifier: BSD-3-Clause
#include "PacketCapture.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>

namespace dyslam
{
namespace
{
std::uint16_t bigEndian(const std::uint8_t* at)
{
  return static_cast<std::uint16_t>((at[0] << 8U) | at[1]);
}

/** Bytes before the IP header; VLAN tags are not counted. */
std::size_t headerSize(int link)
{
  switch (link)
  {
    case DLT_EN10MB:
      return 14;
    case DLT_LINUX_SLL:
      return 16;
    case DLT_LINUX_SLL2:  // of tcpdump -i any
      return 20;
    case DLT_NULL:
      return 4;
    default:
      return 0;
  }
}

/** Where the IP header begins in a captured frame, behind any number of VLAN tags. */
std::size_t ipHeaderAt(int link, const std::uint8_t* data, std::size_t size)
{
  constexpr std::array<std::uint16_t, 3> tags{0x8100, 0x88a8, 0x9100};
  constexpr std::size_t tag_size = 4;
  std::size_t at = headerSize(link);
  // Before the IP header stands the type of what follows.
  for (; (link == DLT_EN10MB || link == DLT_LINUX_SLL) && size > at + tag_size; at += tag_size)
  {
    if (std::find(tags.begin(), tags.end(), bigEndian(data + at - 2)) == tags.end())
    {
      break;
    }
  }
  return at;
}

constexpr std::uint8_t udp_protocol = 17;

/** An address of `size` bytes. */
IpAddress addressAt(const std::uint8_t* at, std::size_t size)
{
  IpAddress address{};
  std::copy(at, at + size, address.end() - static_cast<std::ptrdiff_t>(size));
  return address;
}

/** The IPv4 datagram of protocol UDP, or its fragment; without data for all others. */
IpFragment udpOfIpv4(const std::uint8_t* header, std::size_t size)
{
  constexpr std::size_t shortest_header = 20;
  if (size < shortest_header || header[9] != udp_protocol)
  {
    return {};
  }
  const std::size_t header_size = static_cast<std::size_t>(header[0] & 0x0fU) * 4;
  if (header_size < shortest_header || size < header_size)
  {
    return {};
  }
  IpFragment fragment;
  fragment.sender = addressAt(header + 12, 4);
  fragment.receiver = addressAt(header + 16, 4);
  fragment.number = bigEndian(header + 4);
  const std::uint16_t place = bigEndian(header + 6);
  fragment.offset = static_cast<std::size_t>(place & 0x1fffU) * 8;
  fragment.more = (place & 0x2000U) != 0;
  fragment.data = header + header_size;
  fragment.size = size - header_size;
  // Ethernet fills up short frames; some programs that write captures leave the length out.
  const std::size_t stated = bigEndian(header + 2);
  if (stated >= header_size)
  {
    fragment.size = std::min(fragment.size, stated - header_size);
  }
  return fragment;
}

/** The IPv6 datagram of protocol UDP, or its fragment; without data for all others. */
IpFragment udpOfIpv6(const std::uint8_t* header, std::size_t size)
{
  constexpr std::size_t header_size = 40;
  constexpr std::size_t extension_unit = 8;
  enum Extension : std::uint8_t
  {
    hop_by_hop = 0,
    routing = 43,
    fragmented = 44,
    destination = 60
  };
  if (size < header_size)
  {
    return {};
  }
  if (const std::size_t stated = bigEndian(header + 4); stated > 0)
  {
    size = std::min(size, header_size + stated);
  }
  IpFragment fragment;
  fragment.sender = addressAt(header + 8, 16);
  fragment.receiver = addressAt(header + 24, 16);
  std::uint8_t next = header[6];
  std::size_t at = header_size;
  while (next == hop_by_hop || next == routing || next == destination)
  {
    if (size < at + extension_unit)
    {
      return {};
    }
    next = header[at];
    at += (header[at + 1] + std::size_t{1}) * extension_unit;
  }
  if (next == fragmented && size >= at + extension_unit)
  {
    next = header[at];
    const std::uint16_t place = bigEndian(header + at + 2);
    fragment.offset = place & 0xfff8U;
    fragment.more = (place & 1U) != 0;
    fragment.number =
        static_cast<std::uint32_t>(bigEndian(header + at + 4)) << 16U | bigEndian(header + at + 6);
    at += extension_unit;
  }
  if (next != udp_protocol || size < at)
  {
    return {};
  }
  fragment.data = header + at;
  fragment.size = size - at;
  return fragment;
}

/** The IP datagram of protocol UDP in a captured frame, or its fragment; without data for all
 * other frames. */
IpFragment udpFragment(int link, const std::uint8_t* data, std::size_t size)
{
  const std::size_t at = ipHeaderAt(link, data, size);
  const int version = at < size ? data[at] >> 4U : 0;
  return version == 4   ? udpOfIpv4(data + at, size - at)
         : version == 6 ? udpOfIpv6(data + at, size - at)
                        : IpFragment{};
}

/** Whether an error of libpcap only says that a .pcapng has interfaces of several kinds, as
 * Ethernet and USB: it reads the frames of those that are like the first. */
bool isOfOtherInterface(const std::string& error)
{
  return error.find("of the first interface") != std::string::npos ||
         error.find("there's no Interface Description Block") != std::string::npos;
}

/** Takes the payload out of a UDP datagram. \return false if there is none. */
bool fillPacket(const std::uint8_t* udp,
                std::size_t size,
                std::uint64_t sender,
                LidarPacket& packet)
{
  constexpr std::size_t header_size = 8;
  if (size < header_size)
  {
    return false;
  }
  const std::size_t stated = bigEndian(udp + 4);  // 0 where the writer left it out
  packet.bytes.assign(udp + header_size,
                      udp + (stated > header_size ? std::min(size, stated) : size));
  packet.stream = sender << 16U | bigEndian(udp + 2);
  return true;
}
}  // namespace

PacketCapture::PacketCapture(const std::string& path) : path_(path), file_(nullptr, &pcap_close)
{
  (void)openBinary(path);
  size_ = std::filesystem::file_size(path);
  std::array<char, PCAP_ERRBUF_SIZE> message{};
  file_.reset(pcap_open_offline(path.c_str(), message.data()));
  if (file_ == nullptr)
  {
    throw UserError(path + ": is not a network capture: " + message.data() +
                    "; give a folder, .pcap, .bag, .db3 or .mcap");
  }
}

bool PacketCapture::next(LidarPacket& packet)
{
  pcap_pkthdr* header = nullptr;
  const u_char* data = nullptr;
  for (;;)
  {
    const int code = pcap_next_ex(file_.get(), &header, &data);
    if (code == PCAP_ERROR && isOfOtherInterface(pcap_geterr(file_.get())))
    {
      has_other_interfaces_ = true;
      continue;
    }
    if (code != 1)
    {
      damage_ = code == PCAP_ERROR ? pcap_geterr(file_.get()) : damage_;
      return false;
    }
    const IpFragment fragment = udpFragment(pcap_datalink(file_.get()), data, header->caplen);
    if (fragment.data == nullptr)
    {
      continue;
    }
    has_cut_frames_ = has_cut_frames_ || header->caplen < header->len;
    const std::uint64_t sender =
        senders_.emplace(fragment.sender, senders_.size() + 1).first->second;
    const bool alone = fragment.offset == 0 && !fragment.more;
    const auto whole = alone ? std::nullopt : fragments_.add(fragment);
    if ((alone && fillPacket(fragment.data, fragment.size, sender, packet)) ||
        (whole && fillPacket(whole->data(), whole->size(), sender, packet)))
    {
      packet.captured =
          static_cast<double>(header->ts.tv_sec) + 1e-6 * static_cast<double>(header->ts.tv_usec);
      return true;
    }
  }
}

std::vector<std::string> PacketCapture::warnings() const
{
  std::vector<std::string> lines;
  if (has_other_interfaces_)
  {
    lines.emplace_back(
        "interfaces of another kind or snapshot length than the first are left out; capture on "
        "that of the lidar alone");
  }
  return lines;
}

std::vector<std::string> PacketCapture::reasonsForNone() const
{
  std::vector<std::string> lines = warnings();
  if (has_cut_frames_)
  {
    lines.emplace_back("frames were cut at capture (tcpdump -s 0 keeps them whole)");
  }
  return lines;
}

std::string PacketCapture::adviceForSeveral() const
{
  return "make a capture of each lidar: tcpdump -r " + path_ +
         " -w one.pcap 'src host ADDRESS and udp dst port PORT'";
}

double PacketCapture::progress() const
{
  const long at = std::ftell(pcap_file(file_.get()));
  return at < 0 || size_ == 0 ? 1.0 : static_cast<double>(at) / static_cast<double>(size_);
}
}  // namespace dyslam
