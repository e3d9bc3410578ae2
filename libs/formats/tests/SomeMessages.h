// SPDX-License-Identifier: BSD-3-Clause
// Messages for the tests of bags, and what is read of them.
#pragma once

#include <dyslam/formats/Bag.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "BagWriters.h"

namespace dyslam
{
/** Two topics that alternate, and one at the end. */
inline std::vector<test::TestMessage> someMessages(std::size_t count)
{
  std::vector<test::TestMessage> messages;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double stamp = 1.6e9 + 0.5 * static_cast<double>(i);
    const std::string data = "message " + std::to_string(i) + std::string(100 + i, 'x');
    messages.push_back({i % 2 == 0 ? "/points" : "/imu",
                        i % 2 == 0 ? "sensor_msgs/PointCloud2" : "sensor_msgs/Imu", stamp, data});
  }
  messages.push_back({"/late", "std_msgs/String", 1.6e9 + 100, "late"});
  return messages;
}

inline std::size_t topicAt(const Bag& bag, const std::string& name)
{
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    if (bag.topics()[i].name == name)
    {
      return i;
    }
  }
  ADD_FAILURE() << "no topic " << name;
  return 0;
}

inline std::vector<std::string> dataOf(Bag& bag, const std::string& topic)
{
  bag.select({topicAt(bag, topic)});
  std::vector<std::string> data;
  BagMessage message;
  while (bag.next(message))
  {
    data.emplace_back(message.data);
  }
  return data;
}

inline void expectAll(const std::string& path, const std::vector<test::TestMessage>& messages)
{
  const auto bag = openBag(path);
  ASSERT_EQ(3U, bag->topics().size()) << path;
  const BagTopic topic = bag->topics()[topicAt(*bag, "/points")];
  EXPECT_EQ("sensor_msgs/PointCloud2", topic.type);
  EXPECT_EQ(5U, topic.messages);
  EXPECT_NEAR(1.6e9, topic.first, 1e-6);
  EXPECT_NEAR(1.6e9 + 4, topic.last, 1e-6);
  EXPECT_EQ(1U, bag->topics()[topicAt(*bag, "/late")].messages);
  std::vector<std::string> expected;
  for (const test::TestMessage& message : messages)
  {
    if (message.topic == "/points")
    {
      expected.push_back(message.data);
    }
  }
  EXPECT_EQ(expected, dataOf(*bag, "/points")) << path;
  EXPECT_EQ(expected, dataOf(*bag, "/points")) << "a second time: " << path;
  EXPECT_EQ(std::vector<std::string>{"late"}, dataOf(*bag, "/late")) << path;
  EXPECT_TRUE(bag->warnings().empty());
}
}  // namespace dyslam
