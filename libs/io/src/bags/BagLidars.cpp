// SPDX-License-Identifier: BSD-3-Clause
#include "BagLidars.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/RosPackets.h>

#include <algorithm>
#include <optional>
#include <set>

#include "BagTopics.h"
#include "recording/LabelPattern.h"

namespace dyslam
{
namespace
{
/** "a, b" of all frames. */
std::string frameNames(const RosTransforms& transforms)
{
  std::set<std::string> known;
  for (const auto& [child, transform] : transforms)
  {
    known.insert(child);
    known.insert(transform.parent);
  }
  return joined(known);
}

/** "; /tf_static states two parents of ..." for each conflict, as the end of an error. */
std::string conflictsIn(const BagFrames& frames)
{
  std::string text;
  for (const std::string& conflict : frames.conflicts)
  {
    text += "; " + conflict;
  }
  return text;
}

/** What to give instead of --base-frame, where only `/tf` has the pose of the lidar: it may change
 * later in the recording, so that the user has to decide. */
std::string poseByTf(Bag& bag, const std::string& base, const BagFrames& frames)
{
  RosTransforms transforms = frames.transforms;
  transforms.merge(constantTransforms(bag));
  const auto T_base_lidar = transformBetween(transforms, base, frames.lidar);
  return T_base_lidar
             ? ": '" + poseText(*T_base_lidar) + "' by /tf, in which it is constant at first"
             : "";
}
}  // namespace

void mountLidar(const std::string& input,
                Bag& bag,
                const BagFrames& frames,
                const ScanConverterOptions& options,
                ScanSink& sink)
{
  const std::string base = plainFrame(options.base_frame);
  if (base.empty())
  {
    const std::string known = baseFrameOf(frames.transforms, frames.lidar);
    if (options.sensor_pose.empty() && !known.empty())
    {
      sink.note("the vehicle is the lidar; --base-frame " + known +
                " takes the pose of the lidar on the vehicle from /tf_static");
    }
    return;
  }
  const auto T_base_lidar = transformBetween(frames.transforms, base, frames.lidar);
  if (!T_base_lidar)
  {
    const std::string names = frameNames(frames.transforms);
    throw UserError(input + ": --base-frame " + base + ": /tf_static does not connect it to '" +
                    frames.lidar + "', the frame of the scans" +
                    (names.empty() ? "; it has no frames" : "; it has the frames " + names) +
                    "; give --sensor-pose instead" + poseByTf(bag, base, frames) +
                    conflictsIn(frames));
  }
  sink.setMounting(*T_base_lidar);
  sink.note("the vehicle is " + base + ", in which /tf_static places the lidar");
}

std::vector<FurtherTopic> furtherTopics(const std::string& input,
                                        Bag& bag,
                                        std::size_t scans,
                                        const BagFrames& frames,
                                        const ScanConverterOptions& options,
                                        ScanSink& sink)
{
  std::vector<FurtherTopic> further;
  const std::vector<std::string> labels = options.furtherLabels();
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    const auto [name, calibration] = splitFurtherTopic(options.further_topics[i]);
    FurtherTopic lidar;
    lidar.calibration = calibration;
    lidar.topic = topicNamed(input, bag, "--further-topic", name,
                             [](const BagTopic& topic)
                             { return RosScanDecoder::reads(topic) || packetMakerOf(topic); });
    const bool is_twice =
        std::any_of(further.begin(), further.end(),
                    [&](const FurtherTopic& other) { return other.topic == lidar.topic; });
    if (lidar.topic == scans || is_twice)
    {
      throw UserError(input + ": --further-topic " + name + ": is " +
                      (is_twice ? "given twice" : "the topic of the first lidar") +
                      "; name each lidar once");
    }
    const std::string frame = frameOfTopic(bag, lidar.topic);
    const auto T_first_lidar = transformBetween(frames.transforms, frames.lidar, frame);
    if (!T_first_lidar)
    {
      throw UserError(input + ": --further-topic " + name +
                      ": /tf_static does not connect its "
                      "frame '" +
                      frame + "' to '" + frames.lidar +
                      "', that of the first lidar; record /tf_static, or convert one lidar" +
                      conflictsIn(frames));
    }
    lidar.T_vehicle_lidar = sink.T_vehicle_lidar() * *T_first_lidar;
    lidar.label = labels[i];
    sink.note(
        "further lidar: " + name + ", label " + lidar.label +
        "; dyslam merges its scans with --set input.further_lidars=" + patternFor(lidar.label));
    further.push_back(lidar);
  }
  return further;
}
}  // namespace dyslam
