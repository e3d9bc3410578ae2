// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

namespace dyslam
{
template <typename T>
void appendBytes(std::string& bytes, T value)
{
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/** A VLP-16 at 10 Hz inside a sphere of 10 m, as a capture file. Laser 3 sees nothing. */
inline std::string captured(std::size_t packets,
                            std::uint8_t model_byte = 0x22,
                            double first_azimuth = 0)
{
  std::string file;
  appendBytes<std::uint32_t>(file, 0xa1b2c3d4);
  appendBytes<std::uint16_t>(file, 2);
  appendBytes<std::uint16_t>(file, 4);
  file += std::string(8, '\0');
  appendBytes<std::uint32_t>(file, 65535);
  appendBytes<std::uint32_t>(file, 1);
  constexpr double packet_time = 12 * 2 * 55.296e-6;
  for (std::size_t n = 0; n < packets; ++n)
  {
    std::string udp;
    for (std::size_t block = 0; block < 12; ++block)
    {
      const double seconds =
          (static_cast<double>(n) + static_cast<double>(block) / 12) * packet_time;
      appendBytes<std::uint16_t>(udp, 0xeeff);
      appendBytes(udp, static_cast<std::uint16_t>(
                           std::fmod(first_azimuth + seconds * 3600.0, 360.0) * 100));
      for (std::size_t k = 0; k < 32; ++k)
      {
        appendBytes<std::uint16_t>(udp, k % 16 == 3 ? 0 : 5000);  // laser 3 sees nothing
        udp += static_cast<char>(51);
      }
    }
    const double time = 3599.5 + static_cast<double>(n) * packet_time;  // over the full hour
    appendBytes(udp, static_cast<std::uint32_t>(std::fmod(time, 3600.0) * 1e6));
    udp += static_cast<char>(0x37);
    udp += static_cast<char>(model_byte);
    std::string frame(12, '\0');
    frame += std::string("\x08\x00\x45\x00", 4) + std::string(7, '\0') + "\x11" +
             std::string(10, '\0') + std::string("\x09\x40\x09\x40", 4);
    frame += static_cast<char>((udp.size() + 8) >> 8U);
    frame += static_cast<char>((udp.size() + 8) & 0xffU);
    frame += std::string(2, '\0') + udp;
    const double captured_at = 1000.0 + static_cast<double>(n) * packet_time;
    appendBytes(file, static_cast<std::uint32_t>(captured_at));
    appendBytes(file, static_cast<std::uint32_t>(std::fmod(captured_at, 1.0) * 1e6));
    appendBytes(file, static_cast<std::uint32_t>(frame.size()));
    appendBytes(file, static_cast<std::uint32_t>(frame.size()));
    file += frame;
  }
  return file;
}
}  // namespace dyslam
