// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/FieldConventions.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct PointField;

/** A topic of scans, by its first message. */
struct RosScanTopic
{
  std::size_t topic = 0;            //!< position in Bag::topics()
  std::string frame;                //!< of the header
  std::size_t points = 0;           //!< of the first scan, with those that have no return
  double bytes = 0;                 //!< of all scans, if they are as large as the first
  bool has_times_or_rings = false;  //!< as a lidar's points have, but not a depth camera's
  bool packets = false;             //!< data packets (RosPackets.h): `points` is unknown, 0
};

/** Makes scans of `sensor_msgs/PointCloud2` and Livox's `CustomMsg`, ROS 1 or ROS 2.
 *
 * The stamp is the header's. Every point is kept in its order. Names and units of the drivers'
 * fields are recognised in the first scan:
 *
 * | driver | time | ring |
 * |---|---|---|
 * | Velodyne | `time`, float32 seconds from the stamp | `ring` |
 * | Ouster | `t`, uint32 nanoseconds from the stamp | `ring`, 0 the highest |
 * | Hesai, RoboSense | `timestamp`, float64 seconds since 1970 | `ring` |
 * | Livox | `timestamp`, float64 nanoseconds since 1970, or `offset_time` | `line` |
 *
 * Rings are renumbered so that 0 is the lowest. Without such a field, the rows of an ordered cloud
 * of 2 to 256 rows are the rings. One recording of one lidar for each decoder.
 */
class RosScanDecoder
{
 public:
  /** True for the types that decode() takes. */
  [[nodiscard]] static bool reads(const BagTopic& topic);

  /** Properties of a topic from one of its messages. \pre reads(topic) \throws UserError as
   * decode(). */
  [[nodiscard]] static RosScanTopic summaryOf(const BagTopic& topic, const BagMessage& message);

  /** \throws UserError naming the message and what is wrong with it. */
  [[nodiscard]] Scan decode(const BagTopic& topic, const BagMessage& message);

  /** How the fields were interpreted, a line each: "per-point time: field t, nanoseconds". */
  [[nodiscard]] const std::vector<std::string>& notes() const { return conventions_.notes(); }
  /** What the recording lacks, a line each. */
  [[nodiscard]] const std::vector<std::string>& warnings() const { return conventions_.warnings(); }

 private:
  struct Cloud2;
  Scan decodeCloud(const BagTopic& topic, const BagMessage& message);
  Scan decodeLivox(const BagTopic& topic, const BagMessage& message);
  static const PointField* timeField(const Cloud2& cloud);
  static const PointField* ringField(const Cloud2& cloud);
  void fillIntensity(const Cloud2& cloud, Scan& scan);
  void fillTimes(const Cloud2& cloud, Scan& scan);
  void fillRings(const Cloud2& cloud, Scan& scan);

  FieldConventions conventions_;
  bool first_ = true;
};

/** Topics of scans that have messages, the most likely lidar first: those with times or rings
 * of the points, then packets, then other clouds; then by bytes and messages. Reads the bag up to
 * the first message of each. */
[[nodiscard]] std::vector<RosScanTopic> scanTopics(Bag& bag);
/** A line for each frame of the scans that `/tf_static` places in base_link, or in the root of its
 * transforms: "--sensor-pose 'x y z yaw pitch roll'  (frame in parent, /tf_static)" [m, deg]. */
[[nodiscard]] std::string sensorPosesOf(Bag& bag, const std::vector<RosScanTopic>& scans);

/** A pose or a transform: T_parent_child. */
struct RosPose
{
  double stamp = 0;    //!< of the header [s]
  std::string parent;  //!< frame that the pose is in
  std::string child;   //!< whose pose it is; empty where the message does not say
  Pose pose = Pose::Identity();
};

/** True for `geometry_msgs/PoseStamped`, `PoseWithCovarianceStamped`, `TransformStamped`,
 * `nav_msgs/Odometry` and `tf2_msgs/TFMessage` (`tf/tfMessage`). */
[[nodiscard]] bool isRosPose(const BagTopic& topic);
/** The pose of such a message, or the transforms of a TFMessage, without those that are no pose
 * (not a number, or a quaternion that is none), as a receiver sends before its first fix.
 * \param left_out is increased by the number of these, unless null
 * \throws UserError naming the message and what is wrong with it. */
[[nodiscard]] std::vector<RosPose> decodeRosPoses(const BagTopic& topic,
                                                  const BagMessage& message,
                                                  std::size_t* left_out = nullptr);

using RosTransforms = std::map<std::string, RosPose>;  //!< by child frame
/** The transforms of `/tf_static`; of a damaged bag those before the damage. */
[[nodiscard]] RosTransforms staticTransforms(Bag& bag);
/** T_a_b of two frames; nothing if the transforms do not connect them. */
[[nodiscard]] std::optional<Pose> transformBetween(const RosTransforms& transforms,
                                                   const std::string& a,
                                                   const std::string& b);
/** The frame in which the transforms place another one: base_link if that is among its parents,
 * else the last of them; empty if it has none. */
[[nodiscard]] std::string baseFrameOf(const RosTransforms& transforms, const std::string& frame);
/** Frame of the header of a topic's first message, empty if there is none; "os_sensor", in which
 * their points are, of Ouster's packets.
 * \pre its messages begin with a header, or are such packets. */
[[nodiscard]] std::string frameOfTopic(Bag& bag, std::size_t topic);

/** A sample of an IMU, in the sensor's axes. */
struct RosImu
{
  double stamp = 0;   //!< of the header, else of the recording [s]
  std::string frame;  //!< of the header: the sensor's axes
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  //!< [rad/s]
  std::optional<Eigen::Vector3d> acceleration;                 //!< with gravity [m/s^2]
};
/** True for `sensor_msgs/Imu`. */
[[nodiscard]] bool isRosImu(const BagTopic& topic);
/** Nothing if the angular velocity is unknown (its first covariance is -1) or not a number; an
 * acceleration of that kind is left out. \throws UserError naming the message and what is wrong
 * with it. */
[[nodiscard]] std::optional<RosImu> decodeRosImu(const BagTopic& topic, const BagMessage& message);

/** A position of a satellite receiver. */
struct RosFix
{
  double stamp = 0;   //!< of the header, else of the recording [s]
  std::string frame;  //!< of the header: the antenna
  GeodeticPosition position;
  double horizontal_sigma = 0;  //!< 0: unknown [m]
  double vertical_sigma = 0;    //!< 0: unknown [m]
};
/** True for `sensor_msgs/NavSatFix`. */
[[nodiscard]] bool isRosFix(const BagTopic& topic);
/** Nothing if the receiver had no fix, or the position is none. \throws UserError naming the
 * message and what is wrong with it. */
[[nodiscard]] std::optional<RosFix> decodeRosFix(const BagTopic& topic, const BagMessage& message);

/** The velocity of a body, in its axes. */
struct RosTwist
{
  double stamp = 0;   //!< of the header, else of the recording [s]
  std::string frame;  //!< of the body, whose axes the velocities are in
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   //!< of the frame's origin [m/s]
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  //!< [rad/s]
  std::optional<Pose> T_parent_body;                  //!< of an Odometry, where it is a pose
};
/** True for `nav_msgs/Odometry`, `geometry_msgs/TwistStamped` and `TwistWithCovarianceStamped`. */
[[nodiscard]] bool isRosTwist(const BagTopic& topic);
/** Nothing if a velocity is not a number. \throws UserError naming the message and what is wrong
 * with it. */
[[nodiscard]] std::optional<RosTwist> decodeRosTwist(const BagTopic& topic,
                                                     const BagMessage& message);
}  // namespace dyslam
