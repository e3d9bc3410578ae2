// SPDX-License-Identifier: BSD-3-Clause
// Writers of ROS messages, for tests. They know nothing of the readers.
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace dyslam::test
{
/** A stamp in nanoseconds. \param stamp [s] */
[[nodiscard]] std::uint64_t nanoseconds(double stamp);

/** Puts numbers behind each other as ROS 1 (packed) or CDR (aligned, little-endian) does. */
class MessageBytes
{
 public:
  explicit MessageBytes(bool cdr) : cdr_(cdr), bytes_(cdr ? std::string("\0\1\0\0", 4) : "") {}

  template <typename T>
  MessageBytes& put(T value)
  {
    while (cdr_ && (bytes_.size() - 4) % sizeof(T) != 0)
    {
      bytes_ += '\0';
    }
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  /** Length and bytes; a string of CDR ends with a zero that is counted. */
  MessageBytes& text(const std::string& value);
  MessageBytes& block(const std::string& value);
  /** Sequence number (ROS 1 only), stamp [s, ns] and frame. */
  MessageBytes& header(double stamp, const std::string& frame);

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  bool cdr_;
  std::string bytes_;
};

/** A field of PointCloud2 by its name and type number (2 uint8, 4 uint16, 6 uint32, 7 float32,
 * 8 float64), with a value for each point. */
struct CloudField
{
  std::string name;
  std::uint8_t type = 7;
  std::vector<double> values;
};

/** The fields as a sensor_msgs/PointCloud2 of `rows` rows. */
[[nodiscard]] std::string pointCloud2(bool cdr,
                                      double stamp,
                                      const std::vector<CloudField>& fields,
                                      std::uint32_t rows = 1,
                                      const std::string& frame = "lidar");
/** x y z, `intensity`, `ring` (uint16) and `time` (float32, seconds from the stamp): as Velodyne's
 * driver. */
[[nodiscard]] std::vector<CloudField> velodyneFields(const Scan& scan);
/** velodyne_msgs/VelodyneScan of packets of 1206 bytes, each with its time of reception [s]. */
[[nodiscard]] std::string velodyneScan(bool cdr,
                                       double stamp,
                                       const std::vector<std::pair<double, std::string>>& packets);
/** Kinds of messages with packets of a Hesai. */
enum class HesaiMessage
{
  pandar_scan,    //!< `pandar_msgs/PandarScan`: 1500 bytes for each, then the size
  udp_frame,      //!< `hesai_ros_driver/UdpFrame`: size, bytes, size; only the first has a stamp
  nebula_packets  //!< `nebula_msgs/NebulaPackets`: size, bytes
};
[[nodiscard]] std::string hesaiMessage(bool cdr,
                                       double stamp,
                                       const std::vector<std::pair<double, std::string>>& packets,
                                       HesaiMessage kind);
/** ouster_sensor_msgs/PacketMsg. */
[[nodiscard]] std::string ousterPacketMessage(bool cdr, const std::string& packet);
/** std_msgs/String. */
[[nodiscard]] std::string stringMessage(bool cdr, const std::string& text);
/** geometry_msgs/PoseStamped. */
[[nodiscard]] std::string poseStamped(bool cdr, double stamp, const Pose& pose);
/** nav_msgs/Odometry of base_link. \param linear, angular of the twist [m/s], [rad/s] */
[[nodiscard]] std::string odometry(bool cdr,
                                   double stamp,
                                   const Pose& pose,
                                   const Eigen::Vector3d& linear = Eigen::Vector3d::Zero(),
                                   const Eigen::Vector3d& angular = Eigen::Vector3d::Zero());
/** geometry_msgs/TwistStamped of base_link, or TwistWithCovarianceStamped. */
[[nodiscard]] std::string twistStamped(bool cdr,
                                       double stamp,
                                       const Eigen::Vector3d& linear,
                                       const Eigen::Vector3d& angular,
                                       bool with_covariance = false);
struct ImuValues
{
  std::string frame = "imu_link";
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  //!< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      //!< [m/s^2]
  double angular_velocity_variance = 0.1;                      //!< -1: unknown
  double acceleration_variance = 0.1;                          //!< -1: unknown
};
/** sensor_msgs/Imu. */
[[nodiscard]] std::string imu(bool cdr, double stamp, const ImuValues& values);
struct FixValues
{
  std::string frame = "gps";
  double latitude = 49;    //!< [deg]
  double longitude = 8.4;  //!< [deg]
  double altitude = 115;   //!< [m]
  int status = 0;          //!< -1: no fix
  double variance = 2.25;  //!< of east and north; four times that of up [m^2]; 0: unknown
};
/** sensor_msgs/NavSatFix. */
[[nodiscard]] std::string navSatFix(bool cdr, double stamp, const FixValues& values);
/** tf2_msgs/TFMessage of one transform for each child. */
[[nodiscard]] std::string transforms(bool cdr,
                                     double stamp,
                                     const std::vector<std::pair<std::string, Pose>>& children,
                                     const std::string& parent = "map");
/** livox_ros_driver2/CustomMsg of a scan with times, rings (lines) and intensities of 0..255. */
[[nodiscard]] std::string livoxMessage(bool cdr, const Scan& scan);
}  // namespace dyslam::test
