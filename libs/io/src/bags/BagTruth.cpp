// SPDX-License-Identifier: BSD-3-Clause
#include "BagTruth.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/RosMessages.h>

#include <map>

#include "BagTopics.h"

namespace dyslam
{
Trajectory readTruePoses(const std::string& input,
                         Bag& bag,
                         const ScanConverterOptions& options,
                         ScanSink& sink)
{
  const std::size_t topic = topicNamed(input, bag, "--truth-topic", options.truth_topic, isRosPose);
  const std::string frame = plainFrame(options.truth_frame);
  bag.select({topic});
  std::map<std::string, std::map<double, Pose>> bodies;  // by child frame, in order of time
  BagMessage message;
  std::size_t left_out = 0;
  bool is_in_map = false;  // an Odometry or a transform, whose child is the vehicle
  while (bag.next(message))
  {
    for (const RosPose& pose : decodeRosPoses(bag.topics()[topic], message, &left_out))
    {
      if (frame.empty() || pose.child == frame)
      {
        bodies[pose.child].emplace(pose.stamp != 0 ? pose.stamp : message.recorded, pose.pose);
        is_in_map = is_in_map || (pose.parent == "map" && !pose.child.empty());
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
      appendWord(names, name);
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
  if (is_in_map)
  {
    sink.warn(options.truth_topic +
              ": is in the frame 'map': if it is the result of a SLAM, as /odometry and /tf of "
              "rawlog2bag are, errors against it are differences of two estimates");
  }
  Trajectory trajectory;
  for (const auto& [stamp, pose] : bodies.begin()->second)
  {
    trajectory.push_back(stamp, pose);
  }
  return trajectory;
}
}  // namespace dyslam
