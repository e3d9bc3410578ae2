// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RosPackets.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "RosMessageWriters.h"
#include "SingleMessage.h"

namespace dyslam
{
TEST(RosPackets, WithoutAStampOfTheDriverTheTimeOfRecordingCounts)
{
  const std::vector<std::pair<double, std::string>> packets{{3.5, std::string(1206, 'a')},
                                                            {0, std::string(1206, 'b')}};
  const auto expectTimes = [](const std::string& type, bool cdr, const std::string& bytes)
  {
    const auto read = decodeRosPackets(test::topicOf(cdr, type), test::messageOf(bytes));
    ASSERT_EQ(2U, read.size()) << type;
    EXPECT_EQ(3.5, read[0].received) << type;
    EXPECT_EQ(12, read[1].received) << type;
    EXPECT_EQ(std::string(1206, 'b'), read[1].bytes) << type;
  };
  for (const bool cdr : {false, true})
  {
    expectTimes("velodyne_msgs/VelodyneScan", cdr, test::velodyneScan(cdr, 5, packets));
    expectTimes("hesai_ros_driver/UdpFrame", cdr,
                test::hesaiMessage(cdr, 5, packets, test::HesaiMessage::udp_frame));
  }
}
}  // namespace dyslam
