// SPDX-License-Identifier: BSD-3-Clause
#include "BagTopics.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/io/OptionError.h>
#include <dyslam/io/RecordingOptions.h>

#include <algorithm>
#include <set>

namespace dyslam
{
namespace
{
/** Reports scans of other topics; as a warning, where they may be the lidar's.
 * \param further topics of --further-topic, which are converted, too */
void reportOtherTopics(const Bag& bag,
                       const std::vector<RosScanTopic>& candidates,
                       const std::set<std::string>& further,
                       ScanSink& sink)
{
  const RosScanTopic& taken = candidates.front();
  std::string likely;
  std::string others;
  for (const RosScanTopic& other : candidates)
  {
    if (other.topic != taken.topic && further.count(bag.topics()[other.topic].name) == 0)
    {
      const bool alike =
          other.packets == taken.packets && other.has_times_or_rings == taken.has_times_or_rings;
      appendWord(alike ? likely : others, bag.topics()[other.topic].name);
    }
  }
  if (!likely.empty())
  {
    sink.warn("the scans of " + bag.topics()[taken.topic].name +
              " are converted, which have the most bytes; --topic chooses others: " + likely);
  }
  if (!others.empty())
  {
    sink.note("--topic chooses other scans: " + others);
  }
}
}  // namespace

std::string namesOf(const Bag& bag, const std::function<bool(const BagTopic&)>& wanted)
{
  std::string names;
  for (const BagTopic& topic : bag.topics())
  {
    if (wanted(topic))
    {
      appendWord(names, topic.name);
    }
  }
  return names;
}

std::size_t topicNamed(const std::string& input,
                       const Bag& bag,
                       const std::string& option,
                       const std::string& name,
                       const std::function<bool(const BagTopic&)>& wanted)
{
  const auto& topics = bag.topics();
  for (std::size_t i = 0; i < topics.size(); ++i)
  {
    if (topics[i].name == name && wanted(topics[i]))
    {
      return i;
    }
  }
  const auto found = std::find_if(topics.begin(), topics.end(),
                                  [&name](const BagTopic& topic) { return topic.name == name; });
  const std::string usable = namesOf(bag, wanted);
  const std::string what =
      input + ": " + option + " " + name +
      (found == topics.end() ? " is not in it" : ": " + found->type + " is not read");
  if (usable.empty())
  {
    throw OptionError(what + "; --list shows the topics", "--list");
  }
  throw UserError(what + "; use " + usable);
}

std::size_t scanTopic(const std::string& input,
                      Bag& bag,
                      const ScanConverterOptions& options,
                      ScanSink& sink)
{
  if (!options.topic.empty())
  {
    return topicNamed(input, bag, "--topic", options.topic,
                      [](const BagTopic& topic)
                      { return RosScanDecoder::reads(topic) || packetMakerOf(topic); });
  }
  const std::vector<RosScanTopic> candidates = scanTopics(bag);
  if (!candidates.empty())
  {
    std::set<std::string> further;
    for (const std::string& given : options.further_topics)
    {
      further.insert(splitFurtherTopic(given).topic);
    }
    reportOtherTopics(bag, candidates, further, sink);
    return candidates.front().topic;
  }
  const std::string compressed =
      namesOf(bag, [](const BagTopic& topic)
              { return topic.type.find("CompressedPointCloud2") != std::string::npos; });
  if (!compressed.empty())
  {
    throw UserError(input + ": has no sensor_msgs/PointCloud2, but compressed clouds (" +
                    compressed +
                    "): play it, decode them with point_cloud_transport's republish and record "
                    "the PointCloud2");
  }
  const std::string packets = namesOf(
      bag, [](const BagTopic& topic) { return topic.type.find("Packet") != std::string::npos; });
  if (packets.empty())
  {
    const std::string flat =
        namesOf(bag, [](const BagTopic& topic) { return topic.type == "sensor_msgs/LaserScan"; });
    if (!flat.empty())
    {
      throw UserError(input + ": has no sensor_msgs/PointCloud2, but 2D scans (" + flat +
                      "), which are not read");
    }
    throw OptionError(input + ": has no sensor_msgs/PointCloud2; --list shows the topics",
                      "--list");
  }
  throw UserError(input + ": has no sensor_msgs/PointCloud2, but packets (" + packets +
                  "): play it to the lidar's driver and record its PointCloud2");
}
}  // namespace dyslam
