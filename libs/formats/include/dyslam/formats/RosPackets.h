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

/** Maker of the lidar of a topic of packets; nothing for topics of other types. */
[[nodiscard]] std::optional<PacketMaker> packetMakerOf(const BagTopic& topic);

struct RosPacket
{
  double received = 0;     //!< time of reception, else of the message, UNIX time [s]
  std::string_view bytes;  //!< payload; valid as long as the message
};

/** Packets of a message. \pre packetMakerOf(topic) \throws UserError naming message and problem. */
[[nodiscard]] std::vector<RosPacket> decodeRosPackets(const BagTopic& topic,
                                                      const BagMessage& message);

/** Topics of the packets of the IMUs in Ouster lidars, by their first messages: indices in
 * Bag::topics(). Reads the bag up to these. */
[[nodiscard]] std::vector<std::size_t> ousterImuTopics(Bag& bag);

/** Metadata of an Ouster lidar, published by its driver as `std_msgs/String`. */
struct RosMetadata
{
  std::string topic;  //!< name of the topic: "/ouster/metadata"
  std::string text;   //!< metadata as JSON
};

/** Metadata in a bag; if there are several, those whose topic has the longest common prefix with
 * that of the packets; nothing if there are none. Reads the bag up to the first message of these
 * topics. */
[[nodiscard]] std::optional<RosMetadata> ousterMetadataIn(Bag& bag, const std::string& packets);
}  // namespace dyslam
