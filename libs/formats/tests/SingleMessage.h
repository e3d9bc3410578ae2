// SPDX-License-Identifier: BSD-3-Clause
// A single message, as a bag delivers it.
#pragma once

#include <dyslam/formats/Bag.h>

#include <string>

namespace dyslam::test
{
inline BagTopic topicOf(bool cdr, const std::string& type)
{
  BagTopic topic;
  topic.name = "/topic";
  topic.type = type;
  topic.encoding = cdr ? RosEncoding::cdr : RosEncoding::ros1;
  return topic;
}

inline BagMessage messageOf(const std::string& data)
{
  BagMessage message;
  message.data = data;
  message.recorded = 12;
  message.place = "x.bag: message at byte 99";
  return message;
}
}  // namespace dyslam::test
