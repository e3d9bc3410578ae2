// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>

#include <algorithm>
#include <map>

#include "ScanSink.h"

namespace dyslam
{
namespace
{
constexpr double same_instant = 1e-6;  //!< [s]

std::string namesOf(const Bag& bag, const std::function<bool(const BagTopic&)>& wanted)
{
  std::string names;
  for (const BagTopic& topic : bag.topics())
  {
    if (wanted(topic))
    {
      names += (names.empty() ? "" : ", ") + topic.name;
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
  throw UserError(input + ": " + option + " " + name +
                  (found == topics.end() ? " is not in it" : ": " + found->type + " is not read") +
                  (usable.empty() ? "; --list shows the topics" : "; use " + usable));
}

/** Reports scans of other topics; as a warning, where they may be the lidar's. */
void reportOtherTopics(const Bag& bag, const std::vector<RosScanTopic>& candidates, ScanSink& sink)
{
  const RosScanTopic& taken = candidates.front();
  std::string likely;
  std::string others;
  for (const RosScanTopic& other : candidates)
  {
    if (other.topic != taken.topic)
    {
      std::string& names = other.has_times_or_rings == taken.has_times_or_rings ? likely : others;
      names += (names.empty() ? "" : ", ") + bag.topics()[other.topic].name;
    }
  }
  if (!likely.empty())
  {
    sink.warn("takes the scans of " + bag.topics()[taken.topic].name +
              ", the most bytes of points; if others are meant, --topic: " + likely);
  }
  if (!others.empty())
  {
    sink.note("--topic chooses other scans: " + others);
  }
}

/** The topic of the scans: the requested one, or the most likely lidar. */
std::size_t scanTopic(const std::string& input, Bag& bag, const std::string& asked, ScanSink& sink)
{
  if (!asked.empty())
  {
    return topicNamed(input, bag, "--topic", asked, RosScanDecoder::reads);
  }
  const std::vector<RosScanTopic> candidates = scanTopics(bag);
  if (!candidates.empty())
  {
    reportOtherTopics(bag, candidates, sink);
    return candidates.front().topic;
  }
  const std::string packets = namesOf(bag,
                                      [](const BagTopic& topic)
                                      {
                                        return topic.type.find("Packet") != std::string::npos ||
                                               topic.type == "velodyne_msgs/VelodyneScan";
                                      });
  throw UserError(input + ": has no sensor_msgs/PointCloud2" +
                  (packets.empty() ? "; --list shows the topics"
                                   : ", but packets (" + packets +
                                         "): play it to the lidar's driver and record its "
                                         "PointCloud2"));
}

/** Poses of one body from a topic of the bag. */
Trajectory readTruth(const std::string& input,
                     Bag& bag,
                     const ScanConverterOptions& options,
                     ScanSink& sink)
{
  const std::size_t topic = topicNamed(input, bag, "--truth-topic", options.truth_topic, isRosPose);
  bag.select({topic});
  std::map<std::string, std::map<double, Pose>> bodies;  // by child frame, in order of time
  BagMessage message;
  std::size_t left_out = 0;
  while (bag.next(message))
  {
    for (const RosPose& pose : decodeRosPoses(bag.topics()[topic], message, &left_out))
    {
      if (options.truth_frame.empty() || pose.child == options.truth_frame)
      {
        bodies[pose.child].emplace(pose.stamp != 0 ? pose.stamp : message.recorded, pose.pose);
      }
    }
  }
  if (left_out > 0)
  {
    sink.warn(options.truth_topic + ": " + counted(left_out, "message") +
              " without a pose (not a number, or no rotation) left out");
  }
  if (bodies.size() != 1)
  {
    std::string names;
    for (const auto& [name, poses] : bodies)
    {
      names += (names.empty() ? "" : ", ") + name;
    }
    throw UserError(input + ": " + options.truth_topic +
                    (bodies.empty()
                         ? " has no poses" + (options.truth_frame.empty()
                                                  ? std::string()
                                                  : " of --truth-frame " + options.truth_frame)
                         : " has poses of " + names + "; choose one with --truth-frame"));
  }
  if (bodies.begin()->second.size() < 2)
  {
    throw UserError(input + ": " + options.truth_topic + " has only one pose" +
                    (bodies.begin()->first.empty() ? "" : " of " + bodies.begin()->first) +
                    "; a trajectory needs two or more, with different time stamps");
  }
  Trajectory trajectory;
  for (const auto& [stamp, pose] : bodies.begin()->second)
  {
    trajectory.push_back(stamp, pose);
  }
  return trajectory;
}

std::optional<Pose> poseAt(const Trajectory& truth, double stamp)
{
  if (const auto same = truth.nearest(stamp, same_instant))
  {
    return truth[*same].pose;
  }
  return truth.at(stamp, truth_max_gap);
}
}  // namespace

void convertBag(const std::string& input, ScanSink& sink, const ScanConverterOptions& options)
{
  const std::unique_ptr<Bag> bag = openBag(input);
  const std::size_t at = scanTopic(input, *bag, options.topic, sink);
  const BagTopic topic = bag->topics()[at];
  const Trajectory truth =
      options.truth_topic.empty() ? Trajectory() : readTruth(input, *bag, options, sink);
  if (!truth.empty())
  {
    sink.setPoseOrigin(PoseSource::given, options.truth_topic);
  }
  for (const std::string& warning : bag->warnings())
  {
    sink.warn(warning);
  }
  sink.note("scans: " + topic.name + " (" + topic.type + ")");
  bag->select({at});
  RosScanDecoder decoder;
  std::size_t without_pose = 0;
  BagMessage message;
  while (bag->next(message))
  {
    Scan scan = decoder.decode(topic, message);
    std::optional<Pose> T_world_lidar;
    if (const auto T_world_vehicle = poseAt(truth, scan.stamp))
    {
      T_world_lidar = *T_world_vehicle * sink.T_vehicle_lidar();
    }
    const std::size_t written = sink.written();
    const bool more = sink.put(std::move(scan), true, T_world_lidar, bag->progress());
    without_pose += sink.written() > written && !T_world_lidar ? 1 : 0;
    if (!more)
    {
      break;
    }
  }
  if (sink.written() == 0)
  {
    throw UserError(input + ": " + topic.name + " has " + std::to_string(topic.messages) +
                    " scans" +
                    (topic.messages > 0 ? "; " + emptyRange(options) : "; choose another --topic"));
  }
  if (!truth.empty() && without_pose > 0)
  {
    sink.warn(options.truth_topic + ": has no pose within 0.2 s of " +
              std::to_string(without_pose) + " scans");
  }
  for (const std::string& note : decoder.notes())
  {
    sink.note(note);
  }
  for (const std::string& warning : decoder.warnings())
  {
    sink.warn(warning);
  }
}
}  // namespace dyslam
