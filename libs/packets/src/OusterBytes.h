// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/OusterMetadata.h>

#include <cstdint>
#include <cstring>

namespace dyslam
{
/** A number in a packet, little-endian as this machine. */
template <typename T>
T ousterNumberAt(const std::uint8_t* bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

constexpr std::size_t ouster_header_size = 32;  //!< of packets that have one, and of the footer

enum class OusterPacketType : std::uint16_t
{
  lidar = 1,
  imu = 2
};

/** Whether a packet is of a type by its header. \pre the profile is not LEGACY, and the packet has
 * a header */
inline bool hasOusterType(const std::uint8_t* packet,
                          const OusterMetadata& metadata,
                          OusterPacketType type)
{
  const std::uint16_t stated =
      metadata.fusa_header ? *packet : ousterNumberAt<std::uint16_t>(packet);
  return stated == static_cast<std::uint16_t>(type);
}

/** What a packet tells of the mode of the sensor, against that in the metadata. */
enum class OusterMode
{
  unknown,
  same,
  other
};

/** Mode by the number of the sensor's initialization, another after each change of the mode; of the
 * profile LEGACY by encoder and number of the first column. \pre the packet has the size of one of
 * the lidar */
inline OusterMode modeOfOuster(const std::uint8_t* packet, const OusterMetadata& metadata)
{
  constexpr std::uint64_t encoder_turn = 90112;
  if (metadata.profile.isLegacy())
  {
    const std::uint64_t column = ousterNumberAt<std::uint16_t>(packet + 8);
    const std::uint64_t encoder = ousterNumberAt<std::uint32_t>(packet + 12);
    return column == 0 || encoder == 0                           ? OusterMode::unknown
           : encoder * metadata.columns == column * encoder_turn ? OusterMode::same
                                                                 : OusterMode::other;
  }
  constexpr std::uint32_t bits = (1U << 24U) - 1;
  const std::uint32_t initialization =
      ousterNumberAt<std::uint32_t>(packet + (metadata.fusa_header ? 1 : 4)) & bits;
  return initialization == 0 || metadata.initialization == 0 ? OusterMode::unknown
         : initialization == metadata.initialization         ? OusterMode::same
                                                             : OusterMode::other;
}

/** Whether a packet has the serial number of the metadata's sensor, or either is not stated. \pre
 * the profile is not LEGACY, and the packet has a header */
inline bool hasOusterSerial(const std::uint8_t* packet, const OusterMetadata& metadata)
{
  constexpr std::uint64_t bits = (std::uint64_t{1} << 40U) - 1;
  const std::uint64_t stated =
      ousterNumberAt<std::uint64_t>(packet + (metadata.fusa_header ? 11 : 7)) & bits;
  return stated == 0 || metadata.serial == 0 || stated == metadata.serial;
}
}  // namespace dyslam
