// SPDX-License-Identifier: BSD-3-Clause
#include "VelodynePackets.h"

#include <dyslam/core/Quantile.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr double range_unit = 0.002;                 // [m]
constexpr double azimuth_unit = M_PI / 18000;        // [rad]
constexpr double vlp16_firing_time = 55.296e-6;      // [s], a sixteen and its recharge
constexpr double vlp16_laser_time = 2.304e-6;        // [s]
constexpr double hdl32_block_time = 46.08e-6;        // [s]
constexpr double hdl32_laser_time = 1.152e-6;        // [s]
constexpr double hdl64_firing_time = 48.0e-6;        // [s], both banks
constexpr double hdl64_laser_time = 48.0e-6 / 32.0;  // [s], spread evenly
}  // namespace

double microsecondsBetween(std::uint32_t from, std::uint32_t to)
{
  constexpr double hour = 3600e6;
  double difference = static_cast<double>(to) - static_cast<double>(from);
  if (difference < -hour / 2)
  {
    difference += hour;
  }
  return difference;
}

double laserPeriod(std::size_t lasers)
{
  return lasers == 16   ? vlp16_laser_time
         : lasers == 32 ? hdl32_laser_time
         : lasers == 64 ? hdl64_laser_time
                        : 0;
}

std::vector<std::uint16_t> ringsOf(const mrpt::obs::VelodyneCalibration& calibration)
{
  const auto& lasers = calibration.laser_corrections;
  std::vector<std::size_t> order(lasers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&lasers](std::size_t a, std::size_t b)
                   { return lasers[a].verticalCorrection < lasers[b].verticalCorrection; });
  std::vector<std::uint16_t> rings(lasers.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank)
  {
    rings[order[rank]] = static_cast<std::uint16_t>(rank);
  }
  return rings;
}

VelodyneDecoder::VelodyneDecoder(const mrpt::obs::VelodyneCalibration& calibration,
                                 double min_range,
                                 double max_range)
    : min_range_(min_range), max_range_(max_range)
{
  const auto& corrections = calibration.laser_corrections;
  if (corrections.size() != 16 && corrections.size() != 32 && corrections.size() != 64)
  {
    throw std::invalid_argument("a calibration of " + std::to_string(corrections.size()) +
                                " lasers; only those of 16, 32 and 64 are known");
  }
  const auto rings = ringsOf(calibration);
  for (std::size_t i = 0; i < corrections.size(); ++i)
  {
    const auto& c = corrections[i];
    const double elevation = c.verticalCorrection * M_PI / 180;
    lasers_.push_back({std::cos(elevation), std::sin(elevation), c.azimuthCorrection * M_PI / 180,
                       c.distanceCorrection, c.verticalOffsetCorrection,
                       c.horizontalOffsetCorrection, rings[i]});
  }
}

double VelodyneDecoder::azimuthStep(const VelodynePacketView& packet, bool dual) const
{
  // From one firing block to the next; both blocks of a dual return and both banks of an HDL-64E
  // have the same azimuth. The median is robust to a sector that is left out.
  const std::size_t stride = dual || lasers() == 64 ? 2 : 1;
  std::vector<int> steps;
  for (std::size_t block = 0; block + stride < velodyne_blocks; block += stride)
  {
    steps.push_back((36000 + packet.azimuth(block + stride) - packet.azimuth(block)) % 36000);
  }
  return upperMedian(steps);
}

Eigen::Vector3f VelodyneDecoder::point(const Laser& laser, double range, double azimuth) const
{
  // Clockwise azimuth from ahead; the result has x ahead, y left, z up.
  const double turned = azimuth - laser.azimuth_correction;
  const double s = std::sin(turned);
  const double c = std::cos(turned);
  const double flat = range * laser.cos_elevation - laser.vertical_offset * laser.sin_elevation;
  const double right = flat * s - laser.horizontal_offset * c;
  const double ahead = flat * c + laser.horizontal_offset * s;
  const double up = range * laser.sin_elevation + laser.vertical_offset * laser.cos_elevation;
  return Eigen::Vector3d(ahead, -right, up).cast<float>();
}

bool VelodyneDecoder::decodeBlock(const VelodynePacketView& packet,
                                  std::size_t block,
                                  double time,
                                  Scan& scan) const
{
  const bool lower = packet.header(block) == VelodynePacketView::lower_bank;
  if ((!lower && packet.header(block) != VelodynePacketView::upper_bank) ||
      (lower && lasers() != 64))
  {
    return false;
  }
  const bool dual = packet.returnMode() == VelodynePacketView::dual_return && lasers() != 64;
  const double step = azimuthStep(packet, dual);
  const std::size_t firing_block = dual || lasers() == 64 ? block / 2 : block;
  const double block_time = lasers() == 16   ? 2 * vlp16_firing_time
                            : lasers() == 32 ? hdl32_block_time
                                             : hdl64_firing_time;
  for (std::size_t k = 0; k < 32; ++k)
  {
    const std::uint16_t raw = packet.range(block, k);
    // The odd block of a dual pair repeats the even one where there was a single return.
    if (raw == 0 || (dual && block % 2 == 1 && raw == packet.range(block - 1, k)))
    {
      continue;
    }
    const std::size_t number = lasers() == 16 ? k % 16 : k + (lower ? 32 : 0);
    const std::size_t order = lasers() == 16 ? k % 16 : k;
    const double offset = static_cast<double>(order) * laserPeriod(lasers()) +
                          (lasers() == 16 && k >= 16 ? vlp16_firing_time : 0);
    const Laser& laser = lasers_[number];
    const double range = raw * range_unit + laser.distance_correction;
    if (range < min_range_ || range > max_range_)
    {
      continue;
    }
    const double azimuth = (packet.azimuth(block) + step * offset / block_time) * azimuth_unit;
    scan.points.push_back(point(laser, range, azimuth));
    scan.intensity.push_back(static_cast<float>(packet.intensity(block, k)) / 255.0F);
    scan.time.push_back(
        static_cast<float>(time + static_cast<double>(firing_block) * block_time + offset));
    scan.ring.push_back(laser.ring);
  }
  return true;
}
}  // namespace dyslam
