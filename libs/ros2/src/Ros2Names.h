// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** Names of ROS 2 as its middleware spells them: https://design.ros2.org/articles/
 * topic_and_service_names.html. */

/** \param topic "/points" \return "rt/points" */
[[nodiscard]] std::string ddsTopicOf(const std::string& topic);
/** \param dds_topic "rt/points" \return "/points"; empty if it is no topic of ROS 2 */
[[nodiscard]] std::string topicOfDds(const std::string& dds_topic);
/** \param type "sensor_msgs/PointCloud2" or "sensor_msgs/msg/PointCloud2"
 * \return "sensor_msgs::msg::dds_::PointCloud2_" */
[[nodiscard]] std::string ddsTypeOf(const std::string& type);
/** \param dds_type "sensor_msgs::msg::dds_::PointCloud2_" \return "sensor_msgs/PointCloud2"; the
 * same if it is no type of ROS 2 */
[[nodiscard]] std::string typeOfDds(const std::string& dds_type);
}  // namespace dyslam
