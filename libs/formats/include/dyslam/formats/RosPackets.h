// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Makers of lidars whose drivers record data packets in bags. */
enum class PacketMaker
{
  velodyne,  //!< `velodyne_msgs/VelodyneScan`
  hesai,     //!< `PandarScan`, `hesai_ros_driver/UdpFrame`, `nebula_msgs/NebulaPackets`
  ouster     //!< `PacketMsg` of `ouster_ros`, `ouster_msgs`, `ouster_sensor_msgs`
};

/** Nothing for topics of other types. */
[[nodiscard]] std::optional<PacketMaker> packetMakerOf(const BagTopic& topic);

struct RosPacket
{
  double received = 0;     //!< UNIX time [s]; where the driver does not say, that of the message
  std::string_view bytes;  //!< valid as long as the message
};

/** \pre packetMakerOf(topic) \throws UserError naming the message and what is wrong with it. */
[[nodiscard]] std::vector<RosPacket> decodeRosPackets(const BagTopic& topic,
                                                      const BagMessage& message);

/** The metadata of an Ouster lidar, as its driver publishes them as `std_msgs/String`. */
struct RosMetadata
{
  std::string topic;  //!< "/ouster/metadata"
  std::string text;   //!< JSON
};

/** Of several the one whose topic has most in common with that of the packets; nothing if the bag
 * has none. Reads the bag up to the first message of each such topic. */
[[nodiscard]] std::optional<RosMetadata> ousterMetadataIn(Bag& bag, const std::string& packets);
}  // namespace dyslam
