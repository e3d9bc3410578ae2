// SPDX-License-Identifier: BSD-3-Clause
// Network captures of lidars that see a sphere. They know nothing of the readers.
#pragma once

#include <dyslam/base/Bytes.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
inline void appendBigEndian(std::string& bytes, std::size_t value)
{
  bytes += static_cast<char>((value >> 8U) & 0xffU);
  bytes += static_cast<char>(value & 0xffU);
}

/** The beginning of a .pcap of Ethernet frames. */
inline std::string captureHeader()
{
  std::string file;
  appendBytes<std::uint32_t>(file, 0xa1b2c3d4);
  appendBytes<std::uint16_t>(file, 2);
  appendBytes<std::uint16_t>(file, 4);
  file += std::string(8, '\0');
  appendBytes<std::uint32_t>(file, 65535);
  appendBytes<std::uint32_t>(file, 1);
  return file;
}

/** A frame with an IPv4 datagram of UDP, or a part of one.
 * \param place flags and offset of the header. */
inline std::string ipFrame(const std::string& data, std::size_t number, std::size_t place)
{
  std::string frame(12, '\0');
  frame += std::string("\x08\x00\x45\x00", 4);
  frame += std::string(2, '\0');  // the length, which is left out
  appendBigEndian(frame, number);
  appendBigEndian(frame, place);
  return frame + std::string("\x40\x11", 2) + std::string(10, '\0') + data;
}

/** A frame with an IPv6 datagram, or a part of one. \param next what the data are: 17 UDP, else an
 * extension header \param sender last byte of the sender's address */
inline std::string ip6Frame(const std::string& data, char next, char sender = 1)
{
  std::string frame(12, '\0');
  frame += std::string("\x86\xdd\x60\0\0\0", 6);
  appendBigEndian(frame, data.size());
  frame += next;
  frame += '\x40';
  return frame + "\xfe\x80" + std::string(13, '\0') + sender + "\xff\x02" + std::string(13, '\0') +
         "\x01" + data;
}

inline std::string udpDatagram(const std::string& payload, std::size_t port)
{
  std::string udp;
  appendBigEndian(udp, port);
  appendBigEndian(udp, port);
  appendBigEndian(udp, payload.size() + 8);
  return udp + std::string(2, '\0') + payload;
}

inline void appendFrame(std::string& file, double time, const std::string& frame)
{
  appendBytes(file, static_cast<std::uint32_t>(time));
  appendBytes(file, static_cast<std::uint32_t>(std::fmod(time, 1.0) * 1e6));
  appendBytes(file, static_cast<std::uint32_t>(frame.size()));
  appendBytes(file, static_cast<std::uint32_t>(frame.size()));
  file += frame;
}

/** The frames of one datagram, cut into fragments of at most `size` bytes. \pre size % 8 == 0 */
inline std::vector<std::string> fragmentsOf(const std::string& datagram,
                                            std::size_t number,
                                            std::size_t size)
{
  constexpr std::size_t more = 0x2000;
  std::vector<std::string> frames;
  for (std::size_t at = 0; at < datagram.size(); at += size)
  {
    const bool last = at + size >= datagram.size();
    frames.push_back(ipFrame(datagram.substr(at, size), number, (last ? 0 : more) | at / 8));
  }
  return frames;
}

/** A VLP-16 packet of 12 blocks at times since the first packet [s], at 10 Hz. Laser 3 sees
 * nothing. */
inline std::string velodynePacketOf(const std::vector<double>& times,
                                    std::uint8_t model_byte = 0x22,
                                    double first_azimuth = 0)
{
  std::string udp;
  for (const double seconds : times)
  {
    appendBytes<std::uint16_t>(udp, 0xeeff);
    appendBytes(
        udp, static_cast<std::uint16_t>(std::fmod(first_azimuth + seconds * 3600.0, 360.0) * 100));
    for (std::size_t k = 0; k < 32; ++k)
    {
      appendBytes<std::uint16_t>(udp, k % 16 == 3 ? 0 : 5000);  // laser 3 sees nothing
      udp += static_cast<char>(51);
    }
  }
  const double clock = 3599.5 + times.front();  // over the full hour
  appendBytes(udp, static_cast<std::uint32_t>(std::fmod(clock, 3600.0) * 1e6));
  udp += static_cast<char>(0x37);
  udp += static_cast<char>(model_byte);
  return udp;
}

/** One whose blocks follow each other without a gap. \param time of the first [s] */
inline std::string velodynePacket(double time,
                                  std::uint8_t model_byte = 0x22,
                                  double first_azimuth = 0)
{
  constexpr double block_time = 2 * 55.296e-6;
  std::vector<double> times;
  for (std::size_t block = 0; block < 12; ++block)
  {
    times.push_back(time + static_cast<double>(block) * block_time);
  }
  return velodynePacketOf(times, model_byte, first_azimuth);
}

/** A VLP-16 at 10 Hz inside a sphere of 10 m, as a capture file. Laser 3 sees nothing. */
inline std::string captured(std::size_t packets,
                            std::uint8_t model_byte = 0x22,
                            double first_azimuth = 0)
{
  constexpr double packet_time = 12 * 2 * 55.296e-6;
  constexpr std::size_t port = 2368;
  std::string file = captureHeader();
  for (std::size_t n = 0; n < packets; ++n)
  {
    const double time = static_cast<double>(n) * packet_time;
    const std::string packet = velodynePacket(time, model_byte, first_azimuth);
    appendFrame(file, 1000.0 + time, ipFrame(udpDatagram(packet, port), 0, 0));
  }
  return file;
}
}  // namespace dyslam
