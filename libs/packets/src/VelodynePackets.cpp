// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/packets/VelodynePackets.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr std::size_t returns_in_block = 32;
constexpr double usual_turns_per_second = 10;
constexpr double azimuth_unit = M_PI / 18000;  // [rad]
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

VelodyneDecoder::VelodyneDecoder(VelodyneModel model,
                                 const mrpt::obs::VelodyneCalibration& calibration,
                                 double min_range,
                                 double max_range)
    : model_(model), traits_(traitsOf(model)), min_range_(min_range), max_range_(max_range)
{
  const auto& corrections = calibration.laser_corrections;
  if (corrections.size() != traits_.lasers)
  {
    throw std::invalid_argument("a calibration of " + std::to_string(corrections.size()) +
                                " lasers for a " + traits_.name);
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

bool VelodyneDecoder::isDual(const VelodynePacketView& packet) const
{
  // An HDL-64E does not state it: there the banks of a firing follow each other twice.
  return model_ == VelodyneModel::hdl64e ? packet.bank(0) && packet.bank(0) == packet.bank(2) &&
                                               packet.azimuth(0) == packet.azimuth(2)
                                         : packet.returnMode() == VelodynePacketView::dual_return;
}

std::optional<std::size_t> VelodyneDecoder::firstReturnOf(std::size_t block, bool dual) const
{
  const std::size_t distance = model_ == VelodyneModel::hdl64e ? 2 : 1;
  return dual && block / distance % 2 == 1 ? std::optional(block - distance) : std::nullopt;
}

std::size_t VelodyneDecoder::blocksOfFiring(bool dual) const
{
  return std::max<std::size_t>(1, traits_.lasers / returns_in_block) * (dual ? 2 : 1);
}

double VelodyneDecoder::azimuthStep(const VelodynePacketView& packet, bool dual) const
{
  // From one firing to the next; all blocks of a firing have the same azimuth. The median is robust
  // to a sector that is left out.
  const std::size_t stride = blocksOfFiring(dual);
  std::vector<int> steps;
  for (std::size_t block = 0; block + stride < velodyne_blocks; block += stride)
  {
    if (packet.bank(block) && packet.bank(block + stride))
    {
      steps.push_back((36000 + packet.azimuth(block + stride) - packet.azimuth(block)) % 36000);
    }
  }
  // A packet of a VLS-128 with dual returns has one firing: as at 10 turns per second.
  return steps.empty() ? traits_.firing_time * usual_turns_per_second * 36000 : upperMedian(steps);
}

/** Time from a firing in one block to that in the next one with other firings [s]. */
double VelodyneDecoder::blockTime() const
{
  // Blocks of 16 lasers have two firings each.
  const std::size_t firings = std::max<std::size_t>(1, returns_in_block / traits_.lasers);
  return static_cast<double>(firings) * traits_.firing_time;
}

double VelodyneDecoder::timeOf(const VelodynePacketView& packet, std::size_t block) const
{
  constexpr double least_gap = 3;       // [steps]
  constexpr int farthest_turn = 35000;  // [0.01 deg]; beyond that it is a step back by little
  const bool dual = isDual(packet);
  const std::size_t stride = blocksOfFiring(dual);
  const double least_turn = least_gap * std::max(1.0, azimuthStep(packet, dual));
  double steady_turn = 0;  // of all steps without a gap [0.01 deg]
  double steady_steps = 0;
  double gap_turn = 0;  // of all gaps before the block [0.01 deg]
  double gaps = 0;
  for (std::size_t next = stride; next < velodyne_blocks; next += stride)
  {
    const int turned = (36000 + packet.azimuth(next) - packet.azimuth(next - stride)) % 36000;
    const bool is_known = packet.bank(next) && packet.bank(next - stride) && turned < farthest_turn;
    if (is_known && turned <= least_turn)
    {
      steady_turn += turned;
      ++steady_steps;
    }
    else if (is_known && next <= block)
    {
      gap_turn += turned;
      ++gaps;
    }
  }
  const double blocks = static_cast<double>(block / stride) - gaps;
  return blockTime() *
         (steady_turn > 0 ? blocks + gap_turn * steady_steps / steady_turn : blocks + gaps);
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

/** When a laser shoots, after the first of its firing [s]. \param place of its return in the block
 */
double VelodyneDecoder::shotOffset(std::size_t laser, std::size_t place) const
{
  // Half way through its firing a VLS-128 pauses for a shot; of an HDL-64E both banks shoot at
  // once.
  const std::size_t shot = model_ == VelodyneModel::vls128 ? laser / traits_.at_a_time + laser / 64
                           : model_ == VelodyneModel::hdl64e ? place
                                                             : laser / traits_.at_a_time;
  return static_cast<double>(shot) * traits_.shot_time;
}

bool VelodyneDecoder::decodeBlock(const VelodynePacketView& packet,
                                  std::size_t block,
                                  double time,
                                  Scan& scan) const
{
  if (packet.isPadding(block))
  {
    return true;
  }
  const bool dual = isDual(packet);
  const auto bank = packet.bank(block);
  if (!bank || (*bank > 0 && (*bank + 1) * returns_in_block > traits_.lasers))
  {
    return false;
  }
  const double step = azimuthStep(packet, dual);
  const double block_time = blockTime();
  const double firing_time = time + timeOf(packet, block);
  const auto first_return = firstReturnOf(block, dual);
  for (std::size_t k = 0; k < returns_in_block; ++k)
  {
    const std::uint16_t raw = packet.range(block, k);
    // The second block of a dual pair repeats the first one where there was a single return.
    if (raw == 0 || (first_return && raw == packet.range(*first_return, k)))
    {
      continue;
    }
    const std::size_t number = (*bank * returns_in_block + k) % traits_.lasers;
    const double offset = shotOffset(number, k) + (k >= traits_.lasers ? traits_.firing_time : 0);
    const Laser& laser = lasers_[number];
    const double range = raw * traits_.range_unit + laser.distance_correction;
    if (range < min_range_ || range > max_range_)
    {
      continue;
    }
    const double azimuth = (packet.azimuth(block) + step * offset / block_time) * azimuth_unit;
    scan.points.push_back(point(laser, range, azimuth));
    scan.intensity.push_back(static_cast<float>(packet.intensity(block, k)) / 255.0F);
    scan.time.push_back(static_cast<float>(firing_time + offset));
    scan.ring.push_back(laser.ring);
  }
  return true;
}
}  // namespace dyslam
