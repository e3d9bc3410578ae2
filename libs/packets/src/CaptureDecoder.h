// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/packets/PacketScans.h>
#include <dyslam/packets/PacketSource.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
constexpr unsigned port_bits = 16;  //!< of the receiver's port in LidarPacket::stream

/** Port that a packet was sent to. */
[[nodiscard]] inline std::uint64_t portOf(const LidarPacket& packet)
{
  return packet.stream & ((1U << port_bits) - 1);
}

/** Makes the scans of a capture, and what is known of its lidar. */
struct CaptureDecoder
{
  std::unique_ptr<PacketScans> scans;
  std::string metadata;                     //!< metadata file of an Ouster; empty: a Velodyne
  std::size_t ouster_packet_size = 0;       //!< packet size of an Ouster [bytes]; 0: a Velodyne
  std::uint64_t lidar_port = 0;             //!< port that these metadata state; 0: none
  std::uint64_t imu_port = 0;               //!< of the IMU
  Pose T_vehicle_lidar = Pose::Identity();  //!< that they state
  int fit = 0;  //!< how well these metadata fit the packets; 0: none is of their lidar
  std::string other_metadata;      //!< files beside, of other lidars in the capture
  std::vector<std::string> notes;  //!< for the user
};

/** The decoder for the lidar of an input: by the option, else by its packets, and for an Ouster
 * with those of the metadata beside a capture that fit the packets best. \param packets the first
 * ones \throws UserError for damaged metadata or calibrations. */
[[nodiscard]] CaptureDecoder chooseDecoder(const PacketInput& input,
                                           const PacketSourceOptions& options,
                                           const std::deque<LidarPacket>& packets);
}  // namespace dyslam
