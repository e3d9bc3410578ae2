// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/RecordingOptions.h>

#include <algorithm>
#include <array>

namespace dyslam
{
namespace
{
struct TextOption
{
  const char* flag;
  std::string RecordingOptions::*value;
  bool only_bags;
  const char* with;  //!< the inputs that it works with, if KITTI's folders are none of them
};

constexpr const char* dt_flag = "--dt";

/** All options but dt. */
const std::array<TextOption, 8> text_options{
    {{"--topic", &RecordingOptions::topic, true, "a bag"},
     {"--imu-topic", &RecordingOptions::imu_topic, true, "a bag"},
     {"--odometry-topic", &RecordingOptions::odometry_topic, true, "a bag"},
     {"--gnss-topic", &RecordingOptions::gnss_topic, true, "a bag"},
     {"--sensor", &RecordingOptions::sensor, false, "a .pcap, a bag or a folder of scans"},
     {"--calibration", &RecordingOptions::calibration, false, "the packets of a .pcap or a bag"},
     {"--sensor-pose", &RecordingOptions::sensor_pose, false, nullptr},
     {"--base-frame", &RecordingOptions::base_frame, true, "a bag"}}};
}  // namespace

std::string RecordingOptions::givenFlag() const
{
  for (const TextOption& option : text_options)
  {
    if (!(this->*option.value).empty())
    {
      return option.flag;
    }
  }
  return dt > 0 ? dt_flag : "";
}

bool RecordingOptions::hasFlag(const std::string& flag)
{
  return flag == dt_flag ||
         std::any_of(text_options.begin(), text_options.end(),
                     [&flag](const TextOption& option) { return option.flag == flag; });
}

std::string RecordingOptions::givenFlagOfBags() const
{
  for (const TextOption& option : text_options)
  {
    if (option.only_bags && !(this->*option.value).empty())
    {
      return option.flag;
    }
  }
  return "";
}

void RecordingOptions::requireFittingKitti() const
{
  for (const TextOption& option : text_options)
  {
    if (option.with != nullptr && !(this->*option.value).empty())
    {
      throw UserError(std::string(option.flag) + " works with " + option.with + " only");
    }
  }
}
}  // namespace dyslam
