// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/RecordingOptions.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include "LabelPattern.h"

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

struct RecordingOption
{
  const char* flag;
  Values (*values)(const RecordingOptions& options);  //!< those given
  bool only_bags;
  const char* with;  //!< the inputs that it works with, if KITTI's folders are none of them
};

using Given = const RecordingOptions&;
const std::array<RecordingOption, 10> all_options{
    {{"--topic", [](Given o) { return valuesOf(o.topic); }, true, "a bag"},
     {"--further-topic", [](Given o) { return o.further_topics; }, true, "a bag"},
     {"--imu-topic", [](Given o) { return valuesOf(o.imu_topic); }, true, "a bag"},
     {"--odometry-topic", [](Given o) { return valuesOf(o.odometry_topic); }, true, "a bag"},
     {"--gnss-topic", [](Given o) { return valuesOf(o.gnss_topic); }, true, "a bag"},
     {"--sensor", [](Given o) { return valuesOf(o.sensor); }, false,
      "a .pcap, a bag or a folder of scans"},
     {"--calibration", [](Given o) { return valuesOf(o.calibration); }, false,
      "the packets of a .pcap or a bag"},
     {"--sensor-pose", [](Given o) { return valuesOf(o.sensor_pose); }, false, nullptr},
     {"--base-frame", [](Given o) { return valuesOf(o.base_frame); }, true, "a bag"},
     {"--dt", [](Given o) { return o.dt > 0 ? Values{exactText(o.dt)} : Values(); }, false,
      nullptr}}};
}  // namespace

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
  for (const std::string& topic : further_topics)
  {
    const std::string name = labelOfTopic(topic);
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

std::string RecordingOptions::givenFlagOfBags() const
{
  for (const RecordingOption& option : all_options)
  {
    if (option.only_bags && !option.values(*this).empty())
    {
      return option.flag;
    }
  }
  return "";
}

void RecordingOptions::requireFittingKitti() const
{
  for (const RecordingOption& option : all_options)
  {
    if (option.with != nullptr && !option.values(*this).empty())
    {
      throw UserError(std::string(option.flag) + " works with " + option.with + " only");
    }
  }
}
}  // namespace dyslam
