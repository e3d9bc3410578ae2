// SPDX-License-Identifier: BSD-3-Clause
// Messages between two members of a domain, over loopback.
#include <dyslam/base/Error.h>
#include <dyslam/ros2/Ros2Domain.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>
#include <vector>

#include "Ros2Members.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** A serialised message of some bytes, which differ from each other. */
std::string messageOf(std::size_t bytes, char first)
{
  std::string data("\0\1\0\0", 4);
  for (std::size_t i = 0; i < bytes; ++i)
  {
    data += static_cast<char>(first + static_cast<char>(i % 101));
  }
  return data;
}

class Ros2DomainTest : public ::testing::Test
{
 protected:
  /** Publishes, and receives the same. */
  void expectArrives(Ros2Publisher& publisher, const std::string& topic, const std::string& data)
  {
    publisher.publish(data);
    Ros2Message message;
    ASSERT_TRUE(test::receiveNext(*here_, message));
    EXPECT_EQ(topic, message.topic);
    EXPECT_TRUE(data == message.data) << data.size() << " bytes, not " << message.data.size();
    EXPECT_LT(1.6e9, message.received);
  }
  [[nodiscard]] bool isKnown(const std::string& topic) const
  {
    for (const Ros2Topic& known : here_->topics())
    {
      if (known.name == topic && known.publishers > 0)
      {
        return true;
      }
    }
    return false;
  }

  std::unique_ptr<Ros2Domain> there_ = test::joinOwnDomain();
  std::unique_ptr<Ros2Domain> here_ = test::joinOwnDomain();
};
}  // namespace

TEST_F(Ros2DomainTest, MessagesOfAnySizeArriveAsTheyAre)
{
  const auto publisher = there_->advertise({"/points", "sensor_msgs/msg/PointCloud2"});
  ASSERT_TRUE(test::waitUntil([this] { return isKnown("/points"); }));
  ASSERT_EQ(1U, here_->topics().size());
  EXPECT_EQ("sensor_msgs/PointCloud2", here_->topics().front().type);
  here_->subscribe("/points");
  ASSERT_TRUE(test::waitUntil([&] { return publisher->subscriptions() == 1; }));
  for (const std::size_t bytes : {4U, 100000U, 5000000U, 40U})
  {
    expectArrives(*publisher, "/points", messageOf(bytes, 'a'));
  }
  EXPECT_EQ(0U, here_->lost("/points"));
  here_->unsubscribe("/points");
  EXPECT_TRUE(test::waitUntil([&] { return publisher->subscriptions() == 0; }));
}

TEST_F(Ros2DomainTest, ALatchedMessageArrivesLater)
{
  const auto publisher = there_->advertise({"/tf_static", "tf2_msgs/TFMessage", true, true, 1});
  publisher->publish(messageOf(10, 'a'));
  publisher->publish(messageOf(20, 'b'));
  here_->subscribe("/tf_static");
  Ros2Message message;
  ASSERT_TRUE(test::receiveNext(*here_, message));
  EXPECT_EQ(messageOf(20, 'b'), message.data);
}

TEST_F(Ros2DomainTest, WhatIsOfferedIsAskedFor)
{
  here_->subscribe("/imu");  // before there is a publisher
  // A publisher that begins again, reliable then, and once more.
  char content = 'a';
  for (const bool reliable : {false, true, false})
  {
    const auto sensor = there_->advertise({"/imu", "sensor_msgs/Imu", false, reliable, 5});
    const std::string data = messageOf(300, content++);
    // What is sent while a subscription is made does not arrive.
    Ros2Message message;
    EXPECT_TRUE(test::waitUntil(
        [&]
        {
          sensor->publish(data);
          return here_->receive(message, std::chrono::milliseconds(20)) && message.data == data;
        }))
        << "reliable: " << reliable;
  }
}

TEST(Ros2DomainOptions, AreThoseOfTheEnvironment)
{
  ::unsetenv("ROS_DOMAIN_ID");
  ::unsetenv("ROS_LOCALHOST_ONLY");
  EXPECT_EQ(0U, Ros2DomainOptions::fromEnvironment().id);
  EXPECT_FALSE(Ros2DomainOptions::fromEnvironment().localhost_only);
  ::setenv("ROS_DOMAIN_ID", "42", 1);
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_EQ(42U, Ros2DomainOptions::fromEnvironment().id);
  EXPECT_TRUE(Ros2DomainOptions::fromEnvironment().localhost_only);
  for (const std::string bad : {"233", "-1", "x", "1000000000000"})
  {
    ::setenv("ROS_DOMAIN_ID", bad.c_str(), 1);
    EXPECT_EQ("ROS_DOMAIN_ID=" + bad + ": is no domain of ROS 2, which are 0 to 232",
              messageOfError<UserError>([] { (void)Ros2DomainOptions::fromEnvironment(); }));
  }
}
}  // namespace dyslam
