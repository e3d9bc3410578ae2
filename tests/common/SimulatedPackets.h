// SPDX-License-Identifier: BSD-3-Clause
// Data packets of a VLP-16 that sees what the simulator shows. They know nothing of the readers.
#pragma once

#include <dyslam/base/Bytes.h>
#include <dyslam/core/Scan.h>
#include <dyslam/sim/Simulator.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam::test
{
/** A VLP-16 at 10 Hz whose scans have whole packets. */
struct SimulatedPackets
{
  static constexpr std::size_t lasers = 16;
  static constexpr std::size_t columns = 1800;
  static constexpr std::size_t columns_of_packet = 24;  //!< in 12 blocks
  static constexpr std::size_t packets_of_scan = columns / columns_of_packet;
  static constexpr double turn = 0.1;  //!< [s]

  /** Options of a simulator whose scans fit. */
  [[nodiscard]] static sim::SimulatorOptions options()
  {
    sim::SimulatorOptions result;
    result.sensor = sim::SensorKind::vlp16;
    result.columns = static_cast<int>(columns);
    return result;
  }

  /** The packets of a scan. \param number of the scan, from 0 on */
  [[nodiscard]] static std::vector<std::string> of(const Scan& scan, std::size_t number)
  {
    std::vector<std::uint16_t> ranges(columns * lasers, 0);
    std::vector<std::uint8_t> intensities(columns * lasers, 0);
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      const std::size_t place = columnOf(scan.points[i]) * lasers + laserOf(scan.ring[i]);
      ranges[place] = static_cast<std::uint16_t>(
          std::lround(std::min(scan.points[i].norm() / 0.002F, 65535.0F)));
      intensities[place] = static_cast<std::uint8_t>(std::lround(255 * scan.intensity[i]));
    }
    std::vector<std::string> packets;
    for (std::size_t first = 0; first < columns; first += columns_of_packet)
    {
      packets.push_back(packet(ranges, intensities, first, number));
    }
    return packets;
  }

 private:
  /** Number of a column, clockwise from behind, where a scan begins. */
  static std::size_t columnOf(const Eigen::Vector3f& point)
  {
    const double turned = 0.5 - std::atan2(point.y(), point.x()) / (2 * M_PI);  // 0 to 1
    return static_cast<std::size_t>(turned * static_cast<double>(columns) + 0.5) % columns;
  }

  /** Lasers of even number look down, those of odd number up. */
  static std::size_t laserOf(std::size_t ring)
  {
    return ring < lasers / 2 ? 2 * ring : 2 * (ring - lasers / 2) + 1;
  }

  static std::string packet(const std::vector<std::uint16_t>& ranges,
                            const std::vector<std::uint8_t>& intensities,
                            std::size_t first,
                            std::size_t number)
  {
    std::string bytes;
    for (std::size_t column = first; column < first + columns_of_packet; ++column)
    {
      if (column % 2 == 0)
      {
        appendBytes<std::uint16_t>(bytes, 0xeeff);
        const std::size_t azimuth = (18000 + column * 36000 / columns) % 36000;
        appendBytes(bytes, static_cast<std::uint16_t>(azimuth));
      }
      for (std::size_t laser = 0; laser < lasers; ++laser)
      {
        appendBytes(bytes, ranges[column * lasers + laser]);
        bytes += static_cast<char>(intensities[column * lasers + laser]);
      }
    }
    const double seconds =
        turn * (static_cast<double>(number) + static_cast<double>(first) / columns);
    appendBytes(bytes, static_cast<std::uint32_t>(std::lround(seconds * 1e6)));
    return bytes + '\x37' + '\x22';
  }
};
}  // namespace dyslam::test
