// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>
#include <dyslam/formats/RosPackets.h>

#include <set>

#include "RosReader.h"

namespace dyslam
{
namespace
{
constexpr std::size_t velodyne_packet = 1206;  // [bytes]

bool beginsWith(const std::string& text, const std::string& part)
{
  return text.compare(0, part.size(), part) == 0;
}
}  // namespace

std::optional<PacketMaker> packetMakerOf(const BagTopic& topic)
{
  const std::string& type = topic.type;
  if (topic.encoding == RosEncoding::other)
  {
    return std::nullopt;
  }
  if (type == "velodyne_msgs/VelodyneScan")
  {
    return PacketMaker::velodyne;
  }
  const auto slash = type.find('/');
  const bool packets = slash != std::string::npos && type.substr(slash) == "/PacketMsg";
  return packets && beginsWith(type, "ouster") ? std::optional(PacketMaker::ouster) : std::nullopt;
}

std::vector<RosPacket> decodeRosPackets(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  if (packetMakerOf(topic) == PacketMaker::ouster)
  {
    return {{message.recorded, reader.block()}};
  }
  (void)rosHeader(reader, topic.encoding);
  const std::uint32_t count = reader.u32();
  std::vector<RosPacket> packets;
  for (std::uint32_t i = 0; i < count; ++i)
  {
    RosPacket packet;
    packet.received = reader.rosTime();
    packet.bytes = reader.take(velodyne_packet);
    packets.push_back(packet);
  }
  return packets;
}

std::optional<RosMetadata> ousterMetadataIn(Bag& bag, const std::string& packets)
{
  std::vector<std::size_t> texts;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    const BagTopic& topic = bag.topics()[i];
    if (topic.type == "std_msgs/String" && topic.encoding != RosEncoding::other &&
        topic.messages > 0)
    {
      texts.push_back(i);
    }
  }
  std::optional<RosMetadata> best;
  std::set<std::size_t> open(texts.begin(), texts.end());
  bag.select(texts);
  try
  {
    BagMessage message;
    while (!open.empty() && bag.next(message))
    {
      if (open.erase(message.topic) == 0)
      {
        continue;
      }
      const BagTopic& topic = bag.topics()[message.topic];
      ByteReader reader = rosReader(topic, message);
      std::string text = rosString(reader);
      if (text.find("beam_altitude_angles") != std::string::npos &&
          (!best || commonPrefix(topic.name, packets) > commonPrefix(best->topic, packets)))
      {
        best = RosMetadata{topic.name, std::move(text)};
      }
    }
  }
  catch (const UserError&)
  {
    // The conversion reports the damage, if it is of the scans.
  }
  return best;
}
}  // namespace dyslam
