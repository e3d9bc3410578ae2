// SPDX-License-Identifier: BSD-3-Clause
#include "Ros2Names.h"

namespace dyslam
{
namespace
{
const std::string topic_prefix = "rt";
const std::string message_part = "::msg::dds_::";
}  // namespace

std::string ddsTopicOf(const std::string& topic)
{
  return topic_prefix + topic;
}

std::string topicOfDds(const std::string& dds_topic)
{
  const bool is_ros = dds_topic.rfind(topic_prefix + "/", 0) == 0;
  return is_ros ? dds_topic.substr(topic_prefix.size()) : "";
}

std::string ddsTypeOf(const std::string& type)
{
  return type.substr(0, type.find('/')) + message_part + type.substr(type.rfind('/') + 1) + "_";
}

std::string typeOfDds(const std::string& dds_type)
{
  const auto at = dds_type.find(message_part);
  if (at == std::string::npos || dds_type.back() != '_')
  {
    return dds_type;
  }
  const auto name = at + message_part.size();
  return dds_type.substr(0, at) + "/" + dds_type.substr(name, dds_type.size() - name - 1);
}
}  // namespace dyslam
