// SPDX-License-Identifier: BSD-3-Clause
// An Ouster of 4 beams and 64 columns, packet by packet. It knows nothing of the readers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "SyntheticCapture.h"

namespace dyslam
{
struct SyntheticOuster
{
  static constexpr std::size_t beams = 4;
  static constexpr std::size_t columns = 64;
  static constexpr std::size_t packet_columns = 16;
  static constexpr std::size_t packets = columns / packet_columns;
  static constexpr std::size_t header_size = 32;  //!< and size of the footer [bytes]
  static constexpr std::uint64_t serial = 992137000142;
  static constexpr double turn = 0.1;  //!< [s]

  std::string profile = "RNG19_RFL8_SIG16_NIR16";
  std::uint64_t first_time = 100000000000;  //!< of the sensor's clock [ns]
  std::uint64_t sensor = serial;
  std::uint32_t initialization = 0x030201;
  std::size_t lidar_port = 7502;  //!< that of the IMU is the next
  std::size_t first_column = 0;   //!< of the window that has returns
  std::size_t last_column = columns - 1;
  /** Columns of the first frame that see the sky: without returns. */
  std::size_t sky_columns = 0;

  [[nodiscard]] bool isLegacy() const { return profile == "LEGACY"; }
  [[nodiscard]] bool isFusa() const { return profile.rfind("FUSA", 0) == 0; }

  static std::vector<double> altitudes() { return {20, 5, -5.5, -20}; }  //!< [deg]
  static std::vector<double> azimuths() { return {3, 1, -1, -3}; }       //!< [deg]
  /** Range of a pixel [mm], a multiple of 8; 0 for every 16th. */
  static std::uint32_t range(std::size_t beam, std::size_t column)
  {
    return (beam + column) % 16 == 5 ? 0
                                     : static_cast<std::uint32_t>(4000 + 800 * beam + 8 * column);
  }
  /** Of a second return, further off; 0 for every other pixel. */
  static std::uint32_t secondRange(std::size_t beam, std::size_t column)
  {
    return range(beam, column) == 0 || column % 2 == 1 ? 0 : range(beam, column) + 1600;
  }
  static std::uint8_t reflectivity(std::size_t beam, std::size_t column)
  {
    return static_cast<std::uint8_t>(10 * beam + column);
  }

  /** As the sensor gives it; with sections as firmware 3 does. */
  [[nodiscard]] std::string metadata(bool sections = false) const
  {
    const auto list = [](const std::vector<double>& values)
    {
      std::ostringstream text;
      for (const double value : values)
      {
        text << (text.tellp() > 0 ? ", " : "[") << value;
      }
      return text.str() + "]";
    };
    const std::string beams_text = "\"beam_altitude_angles\": " + list(altitudes()) +
                                   ", \"beam_azimuth_angles\": " + list(azimuths()) +
                                   ", \"lidar_origin_to_beam_origin_mm\": 16";
    const std::string pose =
        "\"lidar_to_sensor_transform\": [-1,0,0,0, 0,-1,0,0, 0,0,1,36, 0,0,0,1]";
    const std::string imu_pose =
        "\"imu_to_sensor_transform\": [0,-1,0,6, 1,0,0,-12, 0,0,1,8, 0,0,0,1]";
    const std::string info = "\"prod_line\": \"OS-1-4\", \"prod_sn\": \"" + std::to_string(sensor) +
                             "\", \"initialization_id\": " + std::to_string(initialization);
    const std::string ports = "\"udp_port_lidar\": " + std::to_string(lidar_port) +
                              ", \"udp_port_imu\": " + std::to_string(lidar_port + 1);
    const std::string format =
        "{\"columns_per_frame\": 64, \"columns_per_packet\": 16, \"pixels_per_column\": 4, "
        "\"column_window\": [" +
        std::to_string(first_column) + ", " + std::to_string(last_column) + "]" +
        (isLegacy() ? "" : ", \"udp_profile_lidar\": \"" + profile + "\"") + "}";
    return sections
               ? "{\"sensor_info\": {" + info + "}, \"beam_intrinsics\": {" + beams_text +
                     "}, \"lidar_intrinsics\": {" + pose + "}, \"imu_intrinsics\": {" + imu_pose +
                     "}, \"config_params\": {" + ports + "}, \"lidar_data_format\": " + format + "}"
               : "{" + info + ", " + ports + ", " + beams_text + ", " + pose + ", " + imu_pose +
                     ", \"data_format\": " + format + "}";
  }

  /** Data of one pixel. */
  [[nodiscard]] std::string pixel(std::size_t beam, std::size_t column, bool sky) const
  {
    const std::uint32_t near = sky ? 0 : range(beam, column);
    const std::uint32_t far = sky ? 0 : secondRange(beam, column);
    const std::uint8_t bright = reflectivity(beam, column);
    std::string bytes;
    if (profile == "LEGACY" || profile == "RNG19_RFL8_SIG16_NIR16")
    {
      appendBytes<std::uint32_t>(bytes, near | 0xf0000000U);  // flags in the highest bits
      appendBytes<std::uint16_t>(bytes, bright);
      bytes += std::string(6, '\x11');
    }
    else if (profile == "RNG19_RFL8_SIG16_NIR16_DUAL")
    {
      appendBytes<std::uint32_t>(bytes, near | static_cast<std::uint32_t>(bright) << 24U);
      appendBytes<std::uint32_t>(bytes, far | std::uint32_t{77} << 24U);
      bytes += std::string(8, '\x11');
    }
    else
    {
      appendBytes(bytes, static_cast<std::uint16_t>(near / 8 | 0x8000U));
      bytes += static_cast<char>(bright);
      bytes += '\x11';
      if (profile.find("DUAL") != std::string::npos)
      {
        appendBytes(bytes, static_cast<std::uint16_t>(far / 8));
        bytes += static_cast<char>(77);
        bytes += '\x11';
      }
    }
    return bytes;
  }

  /** The time of a column [ns]. */
  [[nodiscard]] std::uint64_t timeOf(std::size_t frame, std::size_t column) const
  {
    return first_time +
           static_cast<std::uint64_t>(1e9 * turn) * (frame * columns + column) / columns;
  }

  /** Header of a packet. \param type 1: of the lidar, 2: of the IMU */
  [[nodiscard]] std::string header(std::uint16_t type, std::size_t frame) const
  {
    std::string bytes;
    if (isFusa())
    {
      appendBytes<std::uint32_t>(bytes, type | initialization << 8U);
      appendBytes(bytes, static_cast<std::uint32_t>(frame));
      bytes += std::string(3, '\0');
    }
    else
    {
      appendBytes(bytes, type);
      appendBytes(bytes, static_cast<std::uint16_t>(frame));
      appendBytes(bytes, initialization);
      bytes.pop_back();  // it has three bytes
    }
    appendBytes<std::uint64_t>(bytes, sensor);
    bytes.resize(header_size, '\0');
    return bytes;
  }

  /** Packet of the IMU, profile LEGACY. \param time when the gyroscope was read [ns] */
  [[nodiscard]] static std::string imuPacket(std::uint64_t time)
  {
    std::string bytes;
    appendBytes<std::uint64_t>(bytes, 77);              // since the start of the sensor
    appendBytes<std::uint64_t>(bytes, time - 2000000);  // of the accelerometer
    appendBytes(bytes, time);
    for (const float value : {0.5F, -0.25F, 1.0F, 90.0F, -45.0F, 180.0F})  // [g], [deg/s]
    {
      appendBytes(bytes, value);
    }
    return bytes;
  }

  /** Packet of the IMU, profile ACCEL32_GYRO32_NMEA: 8 samples 1 ms apart, the last one invalid.
   * \param time of the first [ns] */
  [[nodiscard]] std::string newImuPacket(std::uint64_t time) const
  {
    constexpr std::uint16_t samples = 8;
    std::string bytes = header(2, 0) + std::string(100, '$');
    for (std::uint16_t i = 0; i < samples; ++i)
    {
      appendBytes<std::uint64_t>(bytes, time + i * std::uint64_t{1000000});
      appendBytes(bytes, i);
      appendBytes<std::uint16_t>(bytes, i + 1 < samples ? 1 : 0);
      for (const float value : {1.0F, -2.0F, 9.75F, 0.5F, -0.25F, 0.125F})  // [m/s^2], [rad/s]
      {
        appendBytes(bytes, value);
      }
    }
    return bytes + std::string(header_size, '\0');
  }

  /** The packet of a frame, from 0 on. */
  [[nodiscard]] std::string packet(std::size_t frame, std::size_t number) const
  {
    std::string bytes;
    if (!isLegacy())
    {
      bytes = header(1, frame);
    }
    for (std::size_t i = 0; i < packet_columns; ++i)
    {
      const std::size_t column = number * packet_columns + i;
      const bool valid = column >= first_column && column <= last_column;
      appendBytes<std::uint64_t>(bytes, timeOf(frame, column));
      appendBytes(bytes, static_cast<std::uint16_t>(column));
      appendBytes(bytes, static_cast<std::uint16_t>(isLegacy() ? frame : (valid ? 1U : 0U)));
      if (isLegacy())
      {
        appendBytes(bytes, static_cast<std::uint32_t>(column * 1408));
      }
      for (std::size_t beam = 0; beam < beams; ++beam)
      {
        bytes += pixel(beam, column, frame == 0 && column < sky_columns);
      }
      if (isLegacy())
      {
        appendBytes<std::uint32_t>(bytes, valid ? 0xffffffffU : 0U);
      }
    }
    return bytes + (isLegacy() ? "" : std::string(header_size, '\0'));
  }

  /** All packets of frames, from the packet `first` on. */
  [[nodiscard]] std::vector<std::string> packetsOf(std::size_t frames, std::size_t first = 0) const
  {
    std::vector<std::string> all;
    for (std::size_t n = first; n < frames * packets; ++n)
    {
      all.push_back(packet(n / packets, n % packets));
    }
    return all;
  }

  /** A capture of these packets, the first at 1000 s; those of the IMU are received with the next
   * one of the lidar. \param fragment_size 0: none [bytes] */
  [[nodiscard]] static std::string capture(const std::vector<std::string>& packets_in,
                                           std::size_t fragment_size = 0)
  {
    constexpr std::size_t imu_size = 48;
    constexpr std::size_t new_imu_size = 452;
    std::string file = captureHeader();
    double time = 1000;
    for (std::size_t n = 0; n < packets_in.size(); ++n)
    {
      const std::size_t size = packets_in[n].size();
      const bool of_imu = size == imu_size || size == new_imu_size;
      const std::string datagram = udpDatagram(packets_in[n], of_imu ? 7503 : 7502);
      auto frames = fragment_size == 0 ? std::vector<std::string>{ipFrame(datagram, n, 0)}
                                       : fragmentsOf(datagram, n, fragment_size);
      std::reverse(frames.begin(), frames.end());  // any order will do
      for (const std::string& frame : frames)
      {
        appendFrame(file, time, frame);
      }
      time += of_imu ? 0 : turn / static_cast<double>(packets);
    }
    return file;
  }
};
}  // namespace dyslam
