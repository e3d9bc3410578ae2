// SPDX-License-Identifier: BSD-3-Clause
// The topics of a domain as a bag; the domain is a script.
#include <dyslam/base/Error.h>
#include <dyslam/ros2/Ros2Topics.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** What a domain has. */
struct Script
{
  std::vector<Ros2Topic> topics;
  std::deque<Ros2Message> messages;  //!< come as fast as they are taken
  std::set<std::string> subscribed;
  std::size_t lost = 0;

  /** Adds a topic and its messages: "/points 0". */
  void add(const std::string& topic, const std::string& type, int count = 2)
  {
    topics.push_back({topic, type, 1});
    for (int i = 0; i < count; ++i)
    {
      messages.push_back({topic, 100.0 + i, topic + " " + std::to_string(i)});
    }
  }
};

class ScriptedDomain : public Ros2Domain
{
 public:
  explicit ScriptedDomain(Script& script) : script_(script) {}

  [[nodiscard]] unsigned id() const override { return 7; }
  [[nodiscard]] std::vector<Ros2Topic> topics() const override { return script_.topics; }
  void subscribe(const std::string& topic) override { script_.subscribed.insert(topic); }
  void unsubscribe(const std::string& topic) override { script_.subscribed.erase(topic); }
  [[nodiscard]] bool receive(Ros2Message& message, std::chrono::milliseconds wait) override
  {
    while (!script_.messages.empty())
    {
      message = script_.messages.front();
      script_.messages.pop_front();
      if (script_.subscribed.count(message.topic) > 0)
      {
        return true;
      }
    }
    std::this_thread::sleep_for(std::min(wait, std::chrono::milliseconds(5)));
    return false;
  }
  [[nodiscard]] std::size_t lost(const std::string& /*topic*/) const override
  {
    return script_.lost;
  }
  [[nodiscard]] std::unique_ptr<Ros2Publisher> advertise(
      const Ros2PublisherOptions& /*options*/) override
  {
    return nullptr;
  }

 private:
  Script& script_;
};

class Ros2TopicsTest : public ::testing::Test
{
 protected:
  Ros2TopicsTest()
  {
    options_.first_wait = 0.2;
    options_.least_look = 0.01;
    options_.silence = 0.05;
    options_.stop = [this] { return stop_; };
    options_.warn = [this](const std::string& line) { warned_.push_back(line); };
  }

  [[nodiscard]] Ros2Topics join()
  {
    return Ros2Topics(std::make_unique<ScriptedDomain>(script_), options_);
  }
  [[nodiscard]] std::string refused()
  {
    return messageOfError<UserError>([this] { (void)join(); });
  }
  /** Contents of the messages up to the end. */
  static std::vector<std::string> rest(Bag& bag)
  {
    std::vector<std::string> contents;
    BagMessage message;
    while (bag.next(message))
    {
      contents.emplace_back(message.data);
    }
    return contents;
  }

  Script script_;
  Ros2TopicsOptions options_;
  bool stop_ = false;
  std::vector<std::string> warned_;
};
using Texts = std::vector<std::string>;
}  // namespace

TEST_F(Ros2TopicsTest, NothingIsLostBetweenTheFirstLookAndTheLast)
{
  script_.add("/points", "sensor_msgs/PointCloud2");
  script_.add("/tf_static", "tf2_msgs/TFMessage", 1);
  script_.add("/image", "sensor_msgs/Image");
  script_.add("/imu", "sensor_msgs/Imu");
  options_.scans = "/points";
  Ros2Topics bag = join();
  ASSERT_EQ(4U, bag.topics().size());
  EXPECT_EQ(2U, bag.topics()[0].messages);
  EXPECT_EQ(100, bag.topics()[0].first);
  EXPECT_EQ(101, bag.topics()[0].last);
  EXPECT_EQ(0U, bag.topics()[2].messages);
  EXPECT_EQ(1U, bag.topics()[3].messages);  // not read, but can be
  EXPECT_EQ((std::set<std::string>{"/points", "/tf_static"}), script_.subscribed);

  // More messages come, which are not there for the first looks.
  script_.messages.push_back({"/points", 102, "/points 2"});
  bag.select({0, 1});
  EXPECT_EQ((Texts{"/points 0", "/points 1", "/tf_static 0"}), rest(bag));
  bag.select({1});
  EXPECT_EQ(Texts{"/tf_static 0"}, rest(bag));

  bag.selectLast({0});
  EXPECT_EQ(std::set<std::string>{"/points"}, script_.subscribed);
  BagMessage message;
  for (const std::string expected : {"/points 0", "/points 1", "/points 2"})
  {
    ASSERT_TRUE(bag.next(message));
    EXPECT_EQ(expected, message.data);
    EXPECT_EQ(0U, message.topic);
  }
  EXPECT_EQ("ROS 2, domain 7: message 3", message.place);
  EXPECT_EQ(102, message.recorded);

  EXPECT_TRUE(bag.warnings().empty());
  script_.lost = 3;
  EXPECT_EQ(1U, bag.warnings().size());
}

TEST_F(Ros2TopicsTest, EndsWhenItIsStopped)
{
  script_.add("/points", "sensor_msgs/PointCloud2");
  Ros2Topics bag = join();
  bag.selectLast({0});
  stop_ = true;
  EXPECT_EQ((Texts{"/points 0", "/points 1"}), rest(bag));
  EXPECT_TRUE(script_.subscribed.empty());
  BagMessage message;
  EXPECT_FALSE(bag.next(message));
  EXPECT_NO_THROW((void)join());  // without looking for topics
}

TEST_F(Ros2TopicsTest, ASilenceIsToldOnce)
{
  script_.add("/points", "sensor_msgs/PointCloud2", 1);
  options_.stop = [this]
  {
    if (warned_.size() == 1 && script_.messages.empty())
    {
      script_.messages.push_back({"/points", 200, "/points later"});
    }
    return warned_.size() == 2;
  };
  Ros2Topics bag = join();
  bag.selectLast({0});
  EXPECT_EQ((Texts{"/points 0", "/points later"}), rest(bag));
  EXPECT_EQ((Texts{"/points: no messages for 0 s; the recording goes on when they come again",
                   "/points: messages again, after 0 s"}),
            warned_);
}

TEST_F(Ros2TopicsTest, WhatIsMissingIsNamed)
{
  script_.add("/dyslam/points_static", "sensor_msgs/PointCloud2");
  EXPECT_EQ(0U, refused().find("ROS 2, domain 7: found no topic within 0.2 s; check that"));
  script_.add("/image", "sensor_msgs/Image");
  options_.scans = "/points";
  EXPECT_EQ(
      "ROS 2, domain 7: /points: has no publisher within 0.2 s; no topic has scans; there are "
      "/image",
      refused());
  script_.add("/rear", "sensor_msgs/PointCloud2", 0);
  EXPECT_EQ("ROS 2, domain 7: /points: has no publisher within 0.2 s; topics with scans are /rear",
            refused());
  options_.scans = "/rear";
  const std::string mute =
      "ROS 2, domain 7: no messages of /rear within 0.2 s, though there is a publisher; is the "
      "lidar on, and does a firewall drop UDP?";
  EXPECT_EQ(mute, refused());
  options_.scans = "";
  EXPECT_EQ(mute, refused());
  script_.add("/points", "sensor_msgs/PointCloud2");
  EXPECT_NO_THROW((void)join());
  script_.messages.push_back({"/points", 100, "/points 0"});
  options_.scans = "/points";
  options_.others = {"/rear"};
  EXPECT_EQ(mute, refused());
}

TEST(Ros2Input, NamesATopic)
{
  EXPECT_EQ("/points", topicOfRos2Input("ros2:/points"));
  EXPECT_EQ("/points", topicOfRos2Input("ros2:points"));
  EXPECT_EQ("", topicOfRos2Input("ros2:"));
}
}  // namespace dyslam
