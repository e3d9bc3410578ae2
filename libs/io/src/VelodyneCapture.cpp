// SPDX-License-Identifier: BSD-3-Clause
#include "VelodyneCapture.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <pcap/pcap.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
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

struct UdpPacket
{
  const std::uint8_t* data = nullptr;  //!< null: none
  std::size_t size = 0;
  std::uint64_t stream = 0;  //!< sender's address and receiver's port: one of each lidar
};

/** The UDP packet in a captured frame; none for other protocols than IPv4 and UDP. */
UdpPacket udpPacket(int link, const std::uint8_t* data, std::size_t size)
{
  std::size_t at = headerSize(link);
  if (link == DLT_EN10MB && size > 18 && bigEndian(data + 12) == 0x8100)
  {
    at += 4;
  }
  if (size < at + 28 || (data[at] >> 4U) != 4 || data[at + 9] != 17)
  {
    return {};
  }
  std::uint64_t stream = 0;
  for (std::size_t i = 12; i < 16; ++i)
  {
    stream = stream << 8U | data[at + i];
  }
  at += static_cast<std::size_t>(data[at] & 0x0fU) * 4;
  if (size < at + 8)
  {
    return {};
  }
  return {data + at + 8, std::min<std::size_t>(size - at - 8, bigEndian(data + at + 4) - 8U),
          stream << 16U | bigEndian(data + at + 2)};
}
}  // namespace

VelodyneCapture::VelodyneCapture(const std::string& path) : file_(nullptr, &pcap_close)
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

bool VelodyneCapture::next(CapturedPacket& packet)
{
  pcap_pkthdr* header = nullptr;
  const u_char* data = nullptr;
  int code = 0;
  while ((code = pcap_next_ex(file_.get(), &header, &data)) == 1)
  {
    const UdpPacket udp = udpPacket(pcap_datalink(file_.get()), data, header->caplen);
    if (udp.data == nullptr || udp.size != velodyne_packet_size)
    {
      continue;
    }
    stream_ = stream_.value_or(udp.stream);
    if (udp.stream != *stream_)
    {
      ++of_others_;
      continue;
    }
    std::memcpy(packet.bytes.data(), udp.data, udp.size);
    packet.captured =
        static_cast<double>(header->ts.tv_sec) + 1e-6 * static_cast<double>(header->ts.tv_usec);
    ++count_;
    return true;
  }
  if (code == PCAP_ERROR)
  {
    damage_ = pcap_geterr(file_.get());
  }
  return false;
}

double VelodyneCapture::progress() const
{
  const long at = std::ftell(pcap_file(file_.get()));
  return at < 0 || size_ == 0 ? 1.0 : static_cast<double>(at) / static_cast<double>(size_);
}
}  // namespace dyslam
