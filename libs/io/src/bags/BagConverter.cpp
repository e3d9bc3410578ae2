// SPDX-License-Identifier: BSD-3-Clause
#include "BagConverter.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/io/OptionError.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "BagMotion.h"
#include "BagScans.h"
#include "BagTopics.h"
#include "HeldScans.h"
#include "recording/LabelPattern.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double same_pose_time = 1e-6;  //!< [s]

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

/** The topic of the scans: the requested one, or the most likely lidar. */
std::size_t scanTopic(const std::string& input, Bag& bag, const std::string& asked, ScanSink& sink)
{
  if (!asked.empty())
  {
    return topicNamed(input, bag, "--topic", asked,
                      [](const BagTopic& topic)
                      { return RosScanDecoder::reads(topic) || packetMakerOf(topic); });
  }
  const std::vector<RosScanTopic> candidates = scanTopics(bag);
  if (!candidates.empty())
  {
    reportOtherTopics(bag, candidates, sink);
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
    throw OptionError(input + ": has no sensor_msgs/PointCloud2; --list shows the topics",
                      "--list");
  }
  throw UserError(input + ": has no sensor_msgs/PointCloud2, but packets (" + packets +
                  "): play it to the lidar's driver and record its PointCloud2");
}

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

/** Mounts the lidar as the bag's transforms have it, if the options ask for that; else a note says
 * that it could. \throws UserError if the transforms do not have its pose. */
void mountLidar(const std::string& input,
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
                    "; give --sensor-pose instead");
  }
  sink.setMounting(*T_base_lidar);
  sink.note("the vehicle is " + base + ", in which /tf_static places the lidar");
}

/** Another lidar of the vehicle. */
struct FurtherTopic
{
  std::size_t topic = 0;
  std::string label;
  std::string calibration;  //!< file; empty: none
  Pose T_vehicle_lidar;
};

/** The topics of --further-topic. \param scans topic of the first lidar \throws UserError if one
 * is missing, or if the transforms do not place its lidar. */
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
                      "', that of the first lidar; record /tf_static, or convert one lidar");
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

PacketOptions optionsOfFirst(const ScanConverterOptions& options)
{
  PacketOptions of_first;
  of_first.sensor = options.sensor;
  of_first.calibration = options.calibration;
  of_first.keep_partial = options.keep_partial;
  return of_first;
}

/** Options for the packets of a further lidar; clouds are never partial. */
PacketOptions optionsOfFurther(const BagTopic& topic, const std::string& calibration, bool partial)
{
  PacketOptions of_further;
  of_further.calibration = calibration;
  of_further.calibration_flag = "--further-topic " + topic.name + "=FILE";
  of_further.keep_partial = partial && packetMakerOf(topic);
  return of_further;
}

/** Poses of one body from a topic of the bag. */
Trajectory readTruth(const std::string& input,
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
  while (bag.next(message))
  {
    for (const RosPose& pose : decodeRosPoses(bag.topics()[topic], message, &left_out))
    {
      if (frame.empty() || pose.child == frame)
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
  Trajectory trajectory;
  for (const auto& [stamp, pose] : bodies.begin()->second)
  {
    trajectory.push_back(stamp, pose);
  }
  return trajectory;
}

std::optional<Pose> poseAt(const Trajectory& truth, double stamp)
{
  if (const auto same = truth.nearest(stamp, same_pose_time))
  {
    return truth[*same].pose;
  }
  return truth.at(stamp, truth_max_gap);
}

/** Passes the scans of one topic, and what other sensors measured, to the sink. */
class BagReader
{
 public:
  BagReader(const std::string& input,
            Bag& bag,
            std::size_t scans,
            const std::vector<FurtherTopic>& further,
            const BagFrames& frames,
            const Trajectory& truth,
            const ScanConverterOptions& options,
            ScanSink& sink)
      : bag_(bag),
        scans_(scans),
        reader_(makeBagScans(input, bag, scans, optionsOfFirst(options))),
        truth_(truth),
        sink_(sink),
        motion_(input, bag, *reader_, frames, options, sink),
        held_(sink, motion_)
  {
    std::vector<std::size_t> topics = motion_.topicsWith(scans);
    for (const FurtherTopic& lidar : further)
    {
      const PacketOptions of_further =
          optionsOfFurther(bag.topics()[lidar.topic], lidar.calibration, options.keep_partial);
      further_.push_back(
          {lidar, further_.size() + 1, makeBagScans(input, bag, lidar.topic, of_further)});
      topics.push_back(lidar.topic);
    }
    bag_.select(topics);
  }

  /** Up to the end of the bag, or until the sink takes no more. Scans before damaged data are
   * passed on. \throws UserError */
  void read()
  {
    while (takeNext() && held_.passOn(message_.recorded))
    {
    }
    finish();
  }

  [[nodiscard]] std::vector<std::string> warnings() const { return reader_->warnings(); }

  /** What was read, as notes and warnings. \param truth_topic topic of the true poses */
  void report(const std::string& truth_topic)
  {
    motion_.report();
    if (!truth_.empty() && held_.withoutPose() > 0)
    {
      std::ostringstream text;
      text << truth_topic << ": has no pose within " << truth_max_gap << " s of "
           << held_.withoutPose() << " scans";
      sink_.warn(text.str());
    }
    report(*reader_);
    for (const FurtherReader& lidar : further_)
    {
      report(*lidar.reader);
      if (lidar.scans == 0)
      {
        sink_.warn(bag_.topics()[lidar.topic.topic].name + ": no scan of this further lidar");
      }
    }
  }

 private:
  struct FurtherReader
  {
    FurtherTopic topic;
    std::size_t number = 1;  //!< HeldScans::Entry::lidar
    std::unique_ptr<BagScans> reader;
    std::size_t scans = 0;
  };

  void report(const BagScans& reader)
  {
    for (const std::string& note : reader.notes())
    {
      sink_.note(note);
    }
    for (const std::string& warning : reader.warnings())
    {
      sink_.warn(warning);
    }
  }

  /** Passes on what was held back. */
  void finish()
  {
    hold(reader_->finish());
    for (FurtherReader& lidar : further_)
    {
      hold(lidar, lidar.reader->finish());
    }
    held_.passOnAll();
  }

  /** \return false at the end of the bag. */
  bool takeNext()
  {
    try
    {
      if (!bag_.next(message_))
      {
        return false;
      }
      takeMessage();
      return true;
    }
    catch (const UserError&)
    {
      finish();
      throw;
    }
  }

  void takeMessage()
  {
    const auto lidar = std::find_if(further_.begin(), further_.end(),
                                    [&](const FurtherReader& other)
                                    { return other.topic.topic == message_.topic; });
    if (lidar != further_.end())
    {
      hold(*lidar, lidar->reader->add(message_));
    }
    else if (message_.topic == scans_)
    {
      hold(reader_->add(message_));
    }
    else
    {
      motion_.add(message_);
    }
  }

  void hold(FurtherReader& lidar, std::vector<Scan> scans)
  {
    for (Scan& scan : scans)
    {
      HeldScans::Entry entry;
      entry.scan = std::move(scan);
      entry.scan.sensor_label = lidar.topic.label;
      entry.scan.T_vehicle_lidar = lidar.topic.T_vehicle_lidar;
      entry.lidar = lidar.number;
      entry.recorded = message_.recorded;
      held_.hold(std::move(entry));
      ++lidar.scans;
    }
  }

  /** \throws UserError if the scans' own label is that of a further lidar. */
  void requireOtherLabel(const Scan& scan) const
  {
    for (const FurtherReader& lidar : further_)
    {
      if (lidar.topic.label == scan.sensor_label)
      {
        throw UserError(bag_.topics()[lidar.topic.topic].name + ": its label in the rawlog, " +
                        lidar.topic.label + ", is that of the first lidar; convert one lidar");
      }
    }
  }

  void hold(std::vector<Scan> scans)
  {
    for (Scan& scan : scans)
    {
      requireOtherLabel(scan);
      HeldScans::Entry entry;
      entry.scan = std::move(scan);
      if (const auto T_world_vehicle = poseAt(truth_, entry.scan.stamp))
      {
        entry.T_world_lidar = *T_world_vehicle * sink_.T_vehicle_lidar();
      }
      entry.recorded = message_.recorded;
      entry.progress = bag_.progress();
      held_.hold(std::move(entry));
    }
  }

  Bag& bag_;
  std::size_t scans_;  //!< topic
  std::unique_ptr<BagScans> reader_;
  std::vector<FurtherReader> further_;
  const Trajectory& truth_;
  ScanSink& sink_;
  BagMotion motion_;
  HeldScans held_;
  BagMessage message_;
};
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
}  // namespace

void convertBag(const std::string& input,
                ScanSink& sink,
                const ScanConverterOptions& options,
                const BagUnpackingProgress& unpacking)
{
  const std::unique_ptr<Bag> bag = openBag(input, unpacking);
  noteParts(input, sink);
  const std::size_t at = scanTopic(input, *bag, options.topic, sink);
  const BagTopic topic = bag->topics()[at];
  const bool is_ouster = packetMakerOf(topic) == PacketMaker::ouster;
  const BagFrames frames{frameOfTopic(*bag, at), staticTransforms(*bag),
                         is_ouster ? ousterImuTopics(*bag) : std::vector<std::size_t>()};
  mountLidar(input, frames, options, sink);
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
  const std::vector<FurtherTopic> further = furtherTopics(input, *bag, at, frames, options, sink);
  BagReader reader(input, *bag, at, further, frames, truth, options, sink);
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
    throw UserError(input + ": " + topic.name + " has " + std::to_string(topic.messages) +
                    " scans" +
                    (topic.messages > 0 ? "; " + emptyRange(options) : "; choose another --topic"));
  }
  reader.report(options.truth_topic);
}
}  // namespace dyslam
