// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/RosPackets.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "RosCloud2.h"

namespace dyslam
{
namespace
{
/** Calls `use` with the first messages of each topic, until it returns true for one, at most 20.
 * Ends at damage, and at a message that `use` throws a UserError for. */
template <typename Use>
void forFirstMessages(Bag& bag, const std::vector<std::size_t>& topics, const Use& use)
{
  constexpr int most = 20;
  std::map<std::size_t, int> open;  // number of messages left, by topic
  for (const std::size_t topic : topics)
  {
    open[topic] = most;
  }
  bag.select(topics);
  try
  {
    BagMessage message;
    while (!open.empty() && bag.next(message))
    {
      const auto topic = open.find(message.topic);
      if (topic != open.end() && (use(message) || --topic->second == 0))
      {
        open.erase(topic);
      }
    }
  }
  catch (const UserError&)
  {
    // The conversion reports the damage, if it is of the topic that is chosen.
  }
}

constexpr const char* ouster_frame = "os_sensor";
constexpr std::size_t least_lidar_packet = 1000;  // [bytes]; those of an IMU are smaller

/** Whether packets are of a lidar: those of an Ouster's IMU come as messages of the same type. */
bool areOfLidar(const BagTopic& topic, const BagMessage& message)
{
  const auto packets = decodeRosPackets(topic, message);
  if (packets.empty() || packetMakerOf(topic) != PacketMaker::ouster)
  {
    return true;
  }
  const std::string_view first = packets.front().bytes;
  const bool of_imu = first.substr(0, 2) == std::string_view("\x02\0", 2);  // the type, if any
  return first.size() >= least_lidar_packet && !of_imu;
}

RosScanTopic packetSummaryOf(const BagTopic& topic, const BagMessage& message)
{
  RosScanTopic summary;
  summary.topic = message.topic;
  summary.packets = true;
  summary.bytes = static_cast<double>(message.data.size()) * static_cast<double>(topic.messages);
  ByteReader reader = rosReader(topic, message);
  summary.frame = packetMakerOf(topic) == PacketMaker::ouster
                      ? ouster_frame
                      : rosHeader(reader, topic.encoding).frame;
  return summary;
}

/** The topics of static transforms: `/tf_static` or, in a bag without it, the only one of a
 * namespace, such as `/robot/tf_static`. */
std::vector<std::size_t> staticTopics(const Bag& bag)
{
  const std::string name = "/tf_static";
  std::vector<std::size_t> plain;
  std::vector<std::size_t> of_namespaces;
  std::set<std::string> names;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    const BagTopic& topic = bag.topics()[i];
    const std::string end = "/" + topic.name;  // the slash may be missing
    if (!isRosPose(topic) || topic.messages == 0 || end.size() < name.size() ||
        end.compare(end.size() - name.size(), name.size(), name) != 0)
    {
      continue;
    }
    if (plainFrame(topic.name) == "tf_static")
    {
      plain.push_back(i);
      continue;
    }
    of_namespaces.push_back(i);
    names.insert(topic.name);
  }
  return plain.empty() && names.size() == 1 ? of_namespaces : plain;
}

bool isSameTransform(const RosPose& a, const RosPose& b)
{
  return a.parent == b.parent && a.pose.isApprox(b.pose, 1e-6);
}

/** Sentence about two transforms of a frame. */
std::string conflictOf(const RosPose& earlier, const RosPose& later)
{
  return earlier.parent == later.parent
             ? "/tf_static states two poses of '" + later.child + "' in '" + later.parent +
                   "'; the last one counts"
             : "/tf_static states two parents of '" + later.child + "', '" + earlier.parent +
                   "' and '" + later.parent + "'; the last one counts";
}

/** Pose of a frame in the last of its parents, or in `last` if that is one of them. */
RosPose poseInParent(const RosTransforms& transforms,
                     const std::string& frame,
                     const std::string& last)
{
  RosPose result;
  result.parent = frame;
  result.child = frame;
  std::set<std::string> passed;  // a loop of frames must not be followed for ever
  for (auto at = transforms.find(frame);
       at != transforms.end() && result.parent != last && passed.insert(result.parent).second;
       at = transforms.find(result.parent))
  {
    result.pose = at->second.pose * result.pose;
    result.parent = at->second.parent;
  }
  return result;
}
}  // namespace

RosTransforms staticTransforms(Bag& bag, std::vector<std::string>* conflicts)
{
  const std::vector<std::size_t> topics = staticTopics(bag);
  RosTransforms by_child;
  std::map<std::string, std::string> conflict_of;  // the last one, by child frame
  if (topics.empty())
  {
    return by_child;
  }
  bag.select(topics);
  try
  {
    BagMessage message;
    while (bag.next(message))
    {
      for (const RosPose& pose : decodeRosPoses(bag.topics()[message.topic], message))
      {
        const auto [known, is_new] = by_child.emplace(pose.child, pose);
        if (!is_new && !isSameTransform(known->second, pose))
        {
          conflict_of[pose.child] = conflictOf(known->second, pose);
          known->second = pose;
        }
      }
    }
  }
  catch (const UserError&)
  {
    // Data before the damage are used.
  }
  if (conflicts != nullptr)
  {
    for (const auto& [child, conflict] : conflict_of)
    {
      conflicts->push_back(conflict);
    }
  }
  return by_child;
}

RosTransforms constantTransforms(Bag& bag)
{
  constexpr double duration = 10;  // [s]
  constexpr std::size_t most = 2000;
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    const BagTopic& topic = bag.topics()[i];
    if (isRosPose(topic) && topic.messages > 0 && plainFrame(topic.name) == "tf")
    {
      topics.push_back(i);
    }
  }
  RosTransforms by_child;
  std::set<std::string> changing;
  if (topics.empty())
  {
    return by_child;
  }
  bag.select(topics);
  try
  {
    BagMessage message;
    std::optional<double> begin;
    for (std::size_t read = 0; read < most && bag.next(message); ++read)
    {
      begin = begin.value_or(message.recorded);
      if (message.recorded > *begin + duration)
      {
        break;
      }
      for (const RosPose& pose : decodeRosPoses(bag.topics()[message.topic], message))
      {
        const RosPose& known = by_child.emplace(pose.child, pose).first->second;
        if (!isSameTransform(known, pose))
        {
          changing.insert(pose.child);
        }
      }
    }
  }
  catch (const UserError&)
  {
    // Data before the damage are used.
  }
  for (const std::string& child : changing)
  {
    by_child.erase(child);
  }
  return by_child;
}

std::optional<Pose> transformBetween(const RosTransforms& transforms,
                                     const std::string& a,
                                     const std::string& b)
{
  const RosPose of_a = poseInParent(transforms, a, "");
  const RosPose of_b = poseInParent(transforms, b, "");
  return of_a.parent == of_b.parent ? std::optional<Pose>(of_a.pose.inverse() * of_b.pose)
                                    : std::nullopt;
}

std::string baseFrameOf(const RosTransforms& transforms, const std::string& frame)
{
  const std::string base = poseInParent(transforms, frame, "base_link").parent;
  return base == frame ? "" : base;
}

std::string frameOfTopic(Bag& bag, std::size_t topic)
{
  if (packetMakerOf(bag.topics()[topic]) == PacketMaker::ouster)
  {
    return ouster_frame;
  }
  std::string frame;
  forFirstMessages(bag, {topic},
                   [&](const BagMessage& message)
                   {
                     const BagTopic& read = bag.topics()[topic];
                     ByteReader reader = rosReader(read, message);
                     frame = rosHeader(reader, read.encoding).frame;
                     return !frame.empty();
                   });
  return frame;
}

std::optional<double> headerStampOf(const BagTopic& topic, const BagMessage& message)
{
  ByteReader reader = rosReader(topic, message);
  const double stamp = rosHeader(reader, topic.encoding).stamp;
  return stamp != 0 ? std::optional(stamp) : std::nullopt;
}

bool clockBeginsAtZero(Bag& bag, std::size_t topic)
{
  constexpr double latest = 60;  // [s]
  double stamp = 0;
  forFirstMessages(bag, {topic},
                   [&](const BagMessage& message)
                   {
                     stamp = headerStampOf(bag.topics()[topic], message).value_or(0);
                     return stamp != 0;
                   });
  return stamp > 0 && stamp <= latest;
}

RosScanTopic RosScanDecoder::summaryOf(const BagTopic& topic, const BagMessage& message)
{
  RosScanTopic summary;
  summary.topic = message.topic;
  summary.bytes = static_cast<double>(message.data.size()) * static_cast<double>(topic.messages);
  ByteReader reader = rosReader(topic, message);
  if (topic.type == "sensor_msgs/PointCloud2")
  {
    const Cloud2 cloud = Cloud2::read(reader, topic.encoding);
    summary.frame = cloud.header.frame;
    summary.points = cloud.size();
    summary.has_times_or_rings = timeField(cloud) != nullptr || ringField(cloud) != nullptr;
    return summary;
  }
  summary.frame = rosHeader(reader, topic.encoding).frame;
  (void)reader.u64();  // time base
  summary.points = reader.u32();
  summary.has_times_or_rings = true;
  return summary;
}

std::vector<std::size_t> ousterImuTopics(Bag& bag)
{
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    const BagTopic& topic = bag.topics()[i];
    if (packetMakerOf(topic) == PacketMaker::ouster && topic.messages > 0)
    {
      topics.push_back(i);
    }
  }
  std::vector<std::size_t> of_imu;
  forFirstMessages(bag, topics,
                   [&](const BagMessage& message)
                   {
                     if (!areOfLidar(bag.topics()[message.topic], message))
                     {
                       of_imu.push_back(message.topic);
                     }
                     return true;
                   });
  return of_imu;
}

std::vector<RosScanTopic> scanTopics(Bag& bag)
{
  std::vector<std::size_t> topics;
  std::vector<RosScanTopic> found;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    const bool packets = packetMakerOf(bag.topics()[i]).has_value();
    if ((packets || RosScanDecoder::reads(bag.topics()[i])) && bag.topics()[i].messages > 0)
    {
      topics.push_back(i);
      found.emplace_back();
      found.back().topic = i;
      found.back().packets = packets;
    }
  }
  std::set<std::size_t> of_others;
  forFirstMessages(bag, topics,
                   [&](const BagMessage& message)
                   {
                     const auto at = std::find(topics.begin(), topics.end(), message.topic);
                     RosScanTopic& summary = found[static_cast<std::size_t>(at - topics.begin())];
                     try
                     {
                       const BagTopic& topic = bag.topics()[message.topic];
                       if (summary.packets && !areOfLidar(topic, message))
                       {
                         of_others.insert(message.topic);
                         return true;
                       }
                       summary = summary.packets ? packetSummaryOf(topic, message)
                                                 : RosScanDecoder::summaryOf(topic, message);
                       return summary.packets || summary.points > 0;  // an empty scan says nothing
                     }
                     catch (const UserError&)
                     {
                       return true;  // scans that cannot be read are the last to be taken
                     }
                   });
  found.erase(
      std::remove_if(found.begin(), found.end(),
                     [&of_others](const RosScanTopic& t) { return of_others.count(t.topic) > 0; }),
      found.end());
  const auto rank = [&bag](const RosScanTopic& t)
  {
    return std::tuple(t.has_times_or_rings || t.packets, !t.packets, t.bytes,
                      bag.topics()[t.topic].messages);
  };
  std::stable_sort(found.begin(), found.end(),
                   [&rank](const auto& a, const auto& b) { return rank(a) > rank(b); });
  return found;
}

namespace
{
/** The lines of sensorPosesOf() for frames that only constantTransforms() connect to base_link.
 * \param said frames that have their line already */
std::string sensorPosesByTf(Bag& bag,
                            const std::vector<RosScanTopic>& scans,
                            const RosTransforms& of_static,
                            std::set<std::string> said)
{
  const bool all_said =
      std::all_of(scans.begin(), scans.end(),
                  [&said](const RosScanTopic& scan) { return said.count(scan.frame) > 0; });
  if (all_said)
  {
    return "";
  }
  RosTransforms transforms = of_static;
  transforms.merge(constantTransforms(bag));
  std::string text;
  for (const RosScanTopic& scan : scans)
  {
    const auto T_base_lidar = transformBetween(transforms, "base_link", scan.frame);
    if (T_base_lidar && scan.frame != "base_link" && said.insert(scan.frame).second)
    {
      text += "--sensor-pose '" + poseText(*T_base_lidar) + "'  (" + scan.frame +
              " in base_link, /tf, in which it is constant at first)\n";
    }
  }
  return text;
}
}  // namespace

std::string sensorPosesOf(Bag& bag, const std::vector<RosScanTopic>& scans)
{
  const RosTransforms transforms = staticTransforms(bag);
  std::set<std::string> said;
  std::string text;
  for (const RosScanTopic& scan : scans)
  {
    const RosPose lidar = poseInParent(transforms, scan.frame, "base_link");
    if (lidar.parent != scan.frame && said.insert(scan.frame).second)
    {
      text += "--sensor-pose '" + poseText(lidar.pose) + "'  (" + scan.frame + " in " +
              lidar.parent + ", /tf_static)\n";
    }
  }
  return text + sensorPosesByTf(bag, scans, transforms, said);
}
}  // namespace dyslam
