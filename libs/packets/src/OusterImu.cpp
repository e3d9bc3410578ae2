// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/packets/OusterImu.h>

#include "OusterBytes.h"

namespace dyslam
{
namespace
{
constexpr std::size_t legacy_size = 48;       // [bytes]
constexpr std::size_t nmea_size = 100;        // of the time and the sentence of a receiver [bytes]
constexpr std::size_t sample_size = 36;       // [bytes]
constexpr double standard_gravity = 9.80665;  // [m/s^2]

Eigen::Vector3d vectorAt(const std::uint8_t* at)
{
  return {ousterNumberAt<float>(at), ousterNumberAt<float>(at + 4), ousterNumberAt<float>(at + 8)};
}

/** Early drivers for ROS recorded a byte more. */
bool isLegacy(const std::vector<std::uint8_t>& packet)
{
  return packet.size() == legacy_size || packet.size() == legacy_size + 1;
}

void append(std::uint64_t time,
            const Eigen::Vector3d& angular_velocity,
            const Eigen::Vector3d& acceleration,
            std::vector<OusterImuSample>& samples)
{
  if (angular_velocity.allFinite())
  {
    samples.push_back({time, angular_velocity,
                       acceleration.allFinite() ? std::optional(acceleration) : std::nullopt});
  }
}
}  // namespace

bool isOusterImuPacket(const std::vector<std::uint8_t>& packet, const OusterMetadata& metadata)
{
  if (isLegacy(packet))
  {
    return true;
  }
  constexpr std::size_t others = 2 * ouster_header_size + nmea_size;
  return !metadata.profile.isLegacy() && packet.size() > others &&
         (packet.size() - others) % sample_size == 0 &&
         hasOusterType(packet.data(), metadata, OusterPacketType::imu) &&
         hasOusterSerial(packet.data(), metadata);
}

std::vector<OusterImuSample> decodeOusterImu(const std::vector<std::uint8_t>& packet)
{
  std::vector<OusterImuSample> samples;
  if (isLegacy(packet))
  {
    // Times of the system, the accelerometer and the gyroscope; g and degrees per second.
    append(ousterNumberAt<std::uint64_t>(&packet[16]), vectorAt(&packet[36]) / degrees_per_radian,
           vectorAt(&packet[24]) * standard_gravity, samples);
    return samples;
  }
  for (std::size_t at = ouster_header_size + nmea_size;
       at + sample_size + ouster_header_size <= packet.size(); at += sample_size)
  {
    const bool is_valid = (ousterNumberAt<std::uint16_t>(&packet[at + 10]) & 1U) != 0;
    if (is_valid)
    {
      append(ousterNumberAt<std::uint64_t>(&packet[at]), vectorAt(&packet[at + 24]),
             vectorAt(&packet[at + 12]), samples);
    }
  }
  return samples;
}
}  // namespace dyslam
