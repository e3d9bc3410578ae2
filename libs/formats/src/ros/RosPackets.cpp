// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RosPackets.h>

#include <set>

#include "RosReader.h"

namespace dyslam
{
namespace
{
constexpr std::size_t velodyne_packet = 1206;  // [bytes]

constexpr std::size_t pandar_room = 1500;  // of each packet in older messages [bytes]

bool beginsWith(const std::string& text, const std::string& part)
{
  return text.compare(0, part.size(), part) == 0;
}

/** What follows the package in the name of a type: "/PandarScan". */
std::string nameIn(const std::string& type)
{
  const auto slash = type.find('/');
  return slash == std::string::npos ? "" : type.substr(slash);
}

/** Some drivers leave the stamp of a packet at 0. */
double receivedOr(double recorded, ByteReader& reader)
{
  const double stamp = reader.rosTime();
  return stamp > 0 ? stamp : recorded;
}

/** The packets of a Hesai, of which the drivers have three kinds of messages: with the room of the
 * largest packet for each and its size behind it, with the size before and behind it, and with the
 * size before it. */
std::vector<RosPacket> hesaiPackets(ByteReader& reader, const BagTopic& topic, double recorded)
{
  constexpr std::size_t stamp_bytes = 8;
  constexpr std::size_t size_bytes = 4;
  const std::uint32_t count = reader.u32();
  const bool has_room = reader.left() == count * (stamp_bytes + pandar_room + size_bytes);
  const bool has_size_behind = nameIn(topic.type) != "/NebulaPackets";
  std::vector<RosPacket> packets;
  for (std::uint32_t i = 0; i < count; ++i)
  {
    RosPacket packet;
    packet.received = receivedOr(recorded, reader);
    packet.bytes = has_room ? reader.take(pandar_room) : reader.block();
    const std::size_t size = has_size_behind ? reader.u32() : packet.bytes.size();
    if (size > packet.bytes.size())
    {
      reader.fail("has a packet of " + std::to_string(size) + " bytes in the room of " +
                  std::to_string(packet.bytes.size()));
    }
    packet.bytes = packet.bytes.substr(0, size);
    packets.push_back(packet);
  }
  return packets;
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
  const std::string name = nameIn(type);
  if (name == "/PandarScan" || name == "/NebulaPackets" ||
      (name == "/UdpFrame" && beginsWith(type, "hesai")))
  {
    return PacketMaker::hesai;
  }
  return name == "/PacketMsg" && beginsWith(type, "ouster") ? std::optional(PacketMaker::ouster)
                                                            : std::nullopt;
}

std::vector<RosPacket> decodeRosPackets(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  if (packetMakerOf(topic) == PacketMaker::ouster)
  {
    return {{message.recorded, reader.block()}};
  }
  (void)rosHeader(reader, topic.encoding);
  if (packetMakerOf(topic) == PacketMaker::hesai)
  {
    return hesaiPackets(reader, topic, message.recorded);
  }
  const std::uint32_t count = reader.u32();
  std::vector<RosPacket> packets;
  for (std::uint32_t i = 0; i < count; ++i)
  {
    RosPacket packet;
    packet.received = receivedOr(message.recorded, reader);
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
