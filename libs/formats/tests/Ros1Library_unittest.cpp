// SPDX-License-Identifier: BSD-3-Clause
// Bags that ROS's own library wrote (Debian's librosbag-storage) are read as they were written.
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/PointCloud2.h>

#include <cstring>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
sensor_msgs::PointCloud2 cloudOf(std::uint32_t number)
{
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = ros::Time(1600000000 + number, 500000000);
  cloud.header.frame_id = "velodyne";
  const std::vector<std::pair<std::string, std::uint8_t>> fields{
      {"x", 7}, {"y", 7}, {"z", 7}, {"intensity", 7}, {"time", 7}};
  for (std::size_t i = 0; i < fields.size(); ++i)
  {
    sensor_msgs::PointField field;
    field.name = fields[i].first;
    field.offset = static_cast<std::uint32_t>(4 * i);
    field.datatype = fields[i].second;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.height = 1;
  cloud.width = 3000;
  cloud.point_step = 20;
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(cloud.row_step);
  for (std::uint32_t i = 0; i < cloud.width; ++i)
  {
    const auto value = static_cast<float>(i + number);
    const float values[5] = {value, -value, 0.5F, 0.25F, 1e-4F * static_cast<float>(i)};
    std::memcpy(&cloud.data[i * cloud.point_step], values, sizeof values);
  }
  return cloud;
}

void write(const std::string& path, rosbag::CompressionType compression, std::uint32_t count)
{
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(100000);
  for (std::uint32_t i = 0; i < count; ++i)
  {
    const auto cloud = cloudOf(i);
    geometry_msgs::PoseStamped pose;
    pose.header.stamp = cloud.header.stamp;
    pose.pose.position.x = i;
    pose.pose.orientation.w = 1;
    bag.write("/pose", cloud.header.stamp, pose);
    bag.write("/points", cloud.header.stamp, cloud);
  }
  bag.close();
}
}  // namespace

TEST(Ros1Library, ItsBagsAreReadAsTheyWereWritten)
{
  const TestFolder folder;
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4})
  {
    write(folder.file("x.bag"), compression, 7);
    const auto bag = openBag(folder.file("x.bag"));
    ASSERT_EQ(2U, bag->topics().size());
    EXPECT_TRUE(bag->warnings().empty());
    bag->select({0, 1});
    RosScanDecoder decoder;
    std::size_t poses = 0;
    std::uint32_t scans = 0;
    BagMessage message;
    while (bag->next(message))
    {
      const BagTopic& topic = bag->topics()[message.topic];
      EXPECT_EQ(7U, topic.messages);
      if (topic.name == "/pose")
      {
        const auto pose = decodeRosPoses(topic, message).at(0);
        EXPECT_EQ(static_cast<double>(poses++), pose.pose.translation().x());
        continue;
      }
      const Scan scan = decoder.decode(topic, message);
      EXPECT_EQ(1600000000.5 + scans, scan.stamp);
      ASSERT_EQ(3000U, scan.size());
      const auto last = static_cast<float>(2999 + scans++);
      EXPECT_EQ(Eigen::Vector3f(last, -last, 0.5F), scan.points.back());
      EXPECT_EQ(0.25F, scan.intensity.back());
      EXPECT_EQ(1e-4F * 2999, scan.time.back());
    }
    EXPECT_EQ(7U, poses);
    EXPECT_EQ(7U, scans);
  }
}
}  // namespace dyslam
