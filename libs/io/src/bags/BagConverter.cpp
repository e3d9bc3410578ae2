// SPDX-License-Identifier: BSD-3-Clause
#include "BagConverter.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/io/OptionError.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "BagLidars.h"
#include "BagReader.h"
#include "BagTopics.h"
#include "BagTruth.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** Names the bags of a folder that nothing states to be parts of one recording. */
void noteParts(const std::string& input, ScanSink& sink)
{
  if (!fs::is_directory(input) || fs::exists(fs::path(input) / "metadata.yaml"))
  {
    return;
  }
  const auto parts = bagParts(input);
  if (parts.size() > 1)
  {
    const auto name = [](const std::string& part) { return fs::path(part).filename().string(); };
    sink.note(input + ": its " + std::to_string(parts.size()) +
              " bags are taken as the parts of one recording, from " + name(parts.front()) +
              " to " + name(parts.back()));
  }
}

/** Warns of clouds in the frame of a map, as other SLAM programs publish them: registered to it
 * again, they show no motion. */
void warnOfMapFrame(const std::string& topic, const std::string& frame, ScanSink& sink)
{
  const std::set<std::string> maps = {"camera_init", "map", "odom", "world"};  // LOAM's: first
  if (maps.count(frame) > 0)
  {
    sink.warn(topic + " is in the frame '" + frame +
              "', which seems to be that of a map: scans are needed as measured, in the frame of "
              "the lidar; choose its topic (--topic)");
  }
}

/** Warns of wheel odometry that is the result of another SLAM, or of an earlier run. */
void warnOfMapOdometry(Bag& bag, const std::string& odometry_topic, ScanSink& sink)
{
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    if (bag.topics()[i].name == odometry_topic && isMapOdometry(bag, i))
    {
      sink.warn(odometry_topic +
                ": is in the frame 'map', as the result of a SLAM or localisation (that of wheels "
                "is in 'odom'); its speeds are then not measured: choose another "
                "--odometry-topic, or none");
    }
  }
}
}  // namespace

void convertBag(const std::string& input,
                ScanSink& sink,
                const ScanConverterOptions& options,
                const BagUnpackingProgress& unpacking)
{
  const std::unique_ptr<Bag> bag = openBag(input, unpacking);
  noteParts(input, sink);
  convertMessages(input, *bag, sink, options);
}

void convertMessages(const std::string& input,
                     Bag& bag,
                     ScanSink& sink,
                     const ScanConverterOptions& options,
                     const std::function<void(const std::string&)>& vehicle_frame)
{
  const std::size_t at = scanTopic(input, bag, options, sink);
  const BagTopic topic = bag.topics()[at];
  const bool is_ouster = packetMakerOf(topic) == PacketMaker::ouster;
  BagContent content{input, bag, at, {}, {}, {}};
  content.frames.lidar = frameOfTopic(bag, at);
  content.frames.transforms = staticTransforms(bag, &content.frames.conflicts);
  content.frames.imu_packets = is_ouster ? ousterImuTopics(bag) : std::vector<std::size_t>();
  for (const std::string& conflict : content.frames.conflicts)
  {
    sink.warn(conflict + "; check the poses of the sensors, or give --sensor-pose");
  }
  warnOfMapFrame(topic.name, content.frames.lidar, sink);
  mountLidar(input, bag, content.frames, options, sink);
  if (vehicle_frame)
  {
    vehicle_frame(options.base_frame.empty() ? content.frames.lidar
                                             : plainFrame(options.base_frame));
  }
  content.truth =
      options.truth_topic.empty() ? Trajectory() : readTruePoses(input, bag, options, sink);
  warnOfMapOdometry(bag, options.odometry_topic, sink);
  for (const std::string& warning : bag.warnings())
  {
    sink.warn(warning);
  }
  sink.note("scans: " + topic.name + " (" + topic.type + ")");
  content.further = furtherTopics(input, bag, at, content.frames, options, sink);
  BagReader reader(content, options, sink);
  reader.read();
  if (sink.seen() == 0 && packetMakerOf(topic))
  {
    const auto warnings = reader.warnings();
    const std::string what = input + ": " + topic.name + " holds no whole revolution";
    if (warnings.empty())
    {
      throw OptionError(what + "; try --keep-partial", "--keep-partial");
    }
    throw UserError(what + ": " + warnings.front());
  }
  if (sink.written() == 0)
  {
    const std::string messages = counted(topic.messages, "message");
    throw UserError(input + ": " + topic.name + " has " + messages +
                    (sink.seen() > 0      ? "; " + emptyRange(options)
                     : topic.messages > 0 ? " without points and time stamp; choose another --topic"
                                          : "; choose another --topic"));
  }
  reader.report(options.truth_topic);
}
}  // namespace dyslam
