// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/RecordingOptions.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <set>

#include "recording/LabelPattern.h"

namespace dyslam
{
namespace
{
using Values = std::vector<std::string>;

/** Read back as the same number. */
std::string exactText(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/** \return the text as a list of one, or of none if it is empty */
Values valuesOf(const std::string& text)
{
  return text.empty() ? Values() : Values{text};
}

std::string labelOfTopic(std::string topic)
{
  topic.erase(0, topic.find_first_not_of('/'));
  std::replace(topic.begin(), topic.end(), '/', '_');
  return topic;
}

bool isOfBag(RecordingKind kind)
{
  return kind == RecordingKind::bag || kind == RecordingKind::topics;
}

bool hasPacketsOnly(RecordingKind kind)
{
  return kind == RecordingKind::capture || kind == RecordingKind::network;
}

bool mayHavePackets(RecordingKind kind)
{
  return isOfBag(kind) || hasPacketsOnly(kind);
}

bool isNotKitti(RecordingKind kind)
{
  return kind != RecordingKind::kitti;
}

bool isKitti(RecordingKind kind)
{
  return kind == RecordingKind::kitti;
}

bool isFolderOfScans(RecordingKind kind)
{
  return kind == RecordingKind::scans;
}

bool hasClouds(RecordingKind kind)
{
  return isFolderOfScans(kind) || isOfBag(kind);
}

bool hasNoTimes(RecordingKind kind)
{
  return !isOfBag(kind) && kind != RecordingKind::network;
}

Values valuesOf(ScansDeskewed deskewed)
{
  return deskewed == ScansDeskewed::automatic
             ? Values()
             : Values{deskewed == ScansDeskewed::yes ? "yes" : "no"};
}

struct RecordingOption
{
  const char* flag;
  Values (*values)(const RecordingOptions& options);  //!< those given
  bool (*fits)(RecordingKind kind);                   //!< null: every kind
  const char* limit;                                  //!< what an error says of the others
};

constexpr const char* bags_only = " works with a bag or topics of ROS 2 only";
constexpr const char* folders_only = " works with a folder of scans only";
using Given = const RecordingOptions&;
const std::array<RecordingOption, 15> all_options{
    {{"--topic", [](Given o) { return valuesOf(o.topic); }, isOfBag, bags_only},
     {"--further-topic", [](Given o) { return o.further_topics; }, isOfBag, bags_only},
     {"--imu-topic", [](Given o) { return valuesOf(o.imu_topic); }, isOfBag, bags_only},
     {"--imu", [](Given o) { return o.imu ? Values{"true"} : Values(); }, hasPacketsOnly,
      " works with a .pcap or a lidar on the network only: --imu-topic names the IMU of a bag, "
      "kitti2rawlog --imu reads "
      "KITTI's"},
     {"--odometry-topic", [](Given o) { return valuesOf(o.odometry_topic); }, isOfBag, bags_only},
     {"--gnss-topic", [](Given o) { return valuesOf(o.gnss_topic); }, isOfBag, bags_only},
     {"--sensor", [](Given o) { return valuesOf(o.sensor); }, isNotKitti,
      " works with packets, a bag or a folder of scans only"},
     {"--calibration", [](Given o) { return valuesOf(o.calibration); }, mayHavePackets,
      " works with packets only: of a .pcap, a bag, a lidar on the network or a live topic"},
     {"--sensor-pose", [](Given o) { return valuesOf(o.sensor_pose); }, nullptr, ""},
     {"--base-frame", [](Given o) { return valuesOf(o.base_frame); }, isOfBag, bags_only},
     {"--dt", [](Given o) { return o.dt > 0 ? Values{exactText(o.dt)} : Values(); }, hasNoTimes,
      ": the scans of a bag and live ones have times; leave it out"},
     {"--bin-layout", [](Given o) { return valuesOf(o.bin_layout); }, isFolderOfScans,
      folders_only},
     {"--scale", [](Given o) { return o.scale != 1 ? Values{exactText(o.scale)} : Values(); },
      hasClouds, " works with a bag or a folder of scans only"},
     {"--deskewed", [](Given o) { return valuesOf(o.deskewed); }, isKitti,
      " works with KITTI's folders only; for other scans that are deskewed already: --set "
      "preprocess.deskew=none"},
     {"--kitti-vertical-angle-correction",
      [](Given o) { return o.vertical_angle_correction ? Values{"true"} : Values(); }, isKitti,
      " works with KITTI's folders only"}}};
}  // namespace

FurtherTopicOption splitFurtherTopic(const std::string& value)
{
  const std::size_t at = value.find('=');
  if (at != std::string::npos && at + 1 == value.size())
  {
    throw UserError("--further-topic " + value +
                    ": names no file; give the topic, or the topic with the calibration of its "
                    "packets, TOPIC=FILE");
  }
  return {value.substr(0, at), at == std::string::npos ? "" : value.substr(at + 1)};
}

std::vector<std::string> RecordingOptions::files() const
{
  std::vector<std::string> result = valuesOf(calibration);
  for (const std::string& further : further_topics)
  {
    const Values file = valuesOf(splitFurtherTopic(further).calibration);
    result.insert(result.end(), file.begin(), file.end());
  }
  return result;
}

RecordingOptions RecordingOptions::withAbsolutePaths() const
{
  const auto absolute = [](const std::string& file)
  { return file.empty() ? file : std::filesystem::absolute(file).string(); };
  RecordingOptions result = *this;
  result.calibration = absolute(calibration);
  for (std::string& further : result.further_topics)
  {
    const FurtherTopicOption given = splitFurtherTopic(further);
    further = given.topic + (given.calibration.empty() ? "" : "=" + absolute(given.calibration));
  }
  return result;
}

std::vector<std::string> RecordingOptions::words() const
{
  std::vector<std::string> result;
  for (const RecordingOption& option : all_options)
  {
    for (const std::string& value : option.values(*this))
    {
      // In one word: the value may begin with a minus.
      result.push_back(std::string(option.flag) + "=" + value);
    }
  }
  return result;
}

std::vector<std::string> RecordingOptions::furtherLabels() const
{
  std::set<std::string> used{firstLabel(), ""};
  std::vector<std::string> labels;
  for (const std::string& further : further_topics)
  {
    const std::string name = labelOfTopic(splitFurtherTopic(further).topic);
    std::string label = name;
    for (int n = 2; !used.insert(label).second; ++n)
    {
      label = name + "_" + std::to_string(n);
    }
    labels.push_back(label);
  }
  return labels;
}

std::string RecordingOptions::furtherLidars() const
{
  std::string pattern;
  for (const std::string& label : furtherLabels())
  {
    pattern += (pattern.empty() ? "" : "|") + patternFor(label);
  }
  if (pattern.size() > LabelPattern::longest)
  {
    throw UserError("--further-topic: the names of all topics are longer than " +
                    std::to_string(LabelPattern::longest) +
                    " characters; convert with scans2rawlog, and give a shorter "
                    "input.further_lidars");
  }
  return pattern;
}

std::string RecordingOptions::givenFlag() const
{
  const auto given =
      std::find_if(all_options.begin(), all_options.end(),
                   [this](const RecordingOption& o) { return !o.values(*this).empty(); });
  return given == all_options.end() ? "" : given->flag;
}

bool RecordingOptions::hasFlag(const std::string& flag)
{
  return std::any_of(all_options.begin(), all_options.end(),
                     [&flag](const RecordingOption& option) { return option.flag == flag; });
}

void RecordingOptions::requireFitting(RecordingKind kind) const
{
  for (const RecordingOption& option : all_options)
  {
    if (option.fits != nullptr && !option.fits(kind) && !option.values(*this).empty())
    {
      throw UserError(option.flag + std::string(option.limit));
    }
  }
  if (!bin_layout.empty())
  {
    requireBinLayout(bin_layout);
  }
}
}  // namespace dyslam
