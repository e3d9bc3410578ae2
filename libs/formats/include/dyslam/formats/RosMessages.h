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
struct RosHeader;

/** Properties of a topic of scans, from its first message. */
struct RosScanTopic
{
  std::size_t topic = 0;            //!< index in Bag::topics()
  std::string frame;                //!< frame_id of the header
  std::size_t points = 0;           //!< number of points of the first scan, also without return
  double bytes = 0;                 //!< estimated size of all scans [bytes]
  bool has_times_or_rings = false;  //!< points have times or rings, unlike a depth camera's
  bool packets = false;             //!< data packets (RosPackets.h); `points` is then 0
};

/** Makes scans of `sensor_msgs/PointCloud2` and Livox's `CustomMsg`, ROS 1 or ROS 2.
 *
 * The stamp is the header's; the time of recording for points without one (a stamp of zero, unless
 * the clock of the headers begins there). Every point is kept in its order. Names and units of the
 * drivers' fields are recognised in the first scan:
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
  /** \param begins_at_zero whether a stamp of zero is one: clockBeginsAtZero() */
  explicit RosScanDecoder(bool begins_at_zero = false) : begins_at_zero_(begins_at_zero) {}

  /** Whether decode() supports the type of a topic. */
  [[nodiscard]] static bool reads(const BagTopic& topic);

  /** Properties of a topic from one of its messages. \pre reads(topic) \throws UserError as
   * decode(). */
  [[nodiscard]] static RosScanTopic summaryOf(const BagTopic& topic, const BagMessage& message);

  /** Decodes a scan. \throws UserError naming the message and the problem. */
  [[nodiscard]] Scan decode(const BagTopic& topic, const BagMessage& message);

  /** Interpretations of the fields, one line each: "per-point time: field t, nanoseconds". */
  [[nodiscard]] const std::vector<std::string>& notes() const { return conventions_.notes(); }
  /** Warnings about data that the recording lacks, one line each. */
  [[nodiscard]] const std::vector<std::string>& warnings() const { return conventions_.warnings(); }

 private:
  struct Cloud2;
  Scan decodeCloud(const BagTopic& topic, const BagMessage& message);
  Scan decodeLivox(const BagTopic& topic, const BagMessage& message);
  double stampOf(const RosHeader& header,
                 const BagTopic& topic,
                 const BagMessage& message,
                 std::size_t points);
  void checkFrame(const RosHeader& header, const BagTopic& topic);
  static const PointField* timeField(const Cloud2& cloud);
  static const PointField* ringField(const Cloud2& cloud);
  void fillIntensity(const Cloud2& cloud, Scan& scan);
  void fillTimes(const Cloud2& cloud, Scan& scan);
  void fillRings(const Cloud2& cloud, Scan& scan);

  FieldConventions conventions_;
  bool begins_at_zero_ = false;
  bool first_ = true;
  std::string frame_;  //!< of the first header that names one
  bool frame_changed_ = false;
};

/** Whether a topic's headers have the clock of a simulator, which begins at zero: the first stamp
 * that is not zero, of its first 20 messages, is at most a minute.
 * \pre its messages begin with a header */
[[nodiscard]] bool clockBeginsAtZero(Bag& bag, std::size_t topic);

/** Topics of scans that have messages, the most likely lidar first: those with times or rings
 * of the points, then packets, then other clouds; then by bytes and messages. Reads the bag up to
 * the first message with points of each, or to its 20th. */
[[nodiscard]] std::vector<RosScanTopic> scanTopics(Bag& bag);
/** A line for each frame of the scans that `/tf_static` places in base_link, or in the root of its
 * transforms: "--sensor-pose 'x y z yaw pitch roll'  (frame in parent, /tf_static)" [m, deg]; or
 * which, with constantTransforms(), `/tf` places in base_link. */
[[nodiscard]] std::string sensorPosesOf(Bag& bag, const std::vector<RosScanTopic>& scans);

/** Name of a frame without a slash before it: drivers of ROS 1 put one there, and tf2 ignores it.
 */
[[nodiscard]] std::string plainFrame(std::string name);

/** A pose or a transform: T_parent_child. */
struct RosPose
{
  double stamp = 0;    //!< stamp of the header, UNIX time [s]
  std::string parent;  //!< parent frame
  std::string child;   //!< child frame; empty if the message does not state it
  Pose pose = Pose::Identity();
};

/** Whether a topic has `geometry_msgs/PoseStamped`, `PoseWithCovarianceStamped`,
 * `TransformStamped`, `nav_msgs/Odometry` and `tf2_msgs/TFMessage` (`tf/tfMessage`). */
[[nodiscard]] bool isRosPose(const BagTopic& topic);
/** The pose of a message of these types, or the transforms of a TFMessage. Invalid poses (not a
 * number, or no quaternion), which receivers send before their first fix, are left out.
 * \param left_out is increased by the number of invalid poses, unless null
 * \throws UserError naming the message and the problem. */
[[nodiscard]] std::vector<RosPose> decodeRosPoses(const BagTopic& topic,
                                                  const BagMessage& message,
                                                  std::size_t* left_out = nullptr);

using RosTransforms = std::map<std::string, RosPose>;  //!< transforms by child frame
/** The transforms of `/tf_static` or, in a bag without it, of the only topic of that name in a
 * namespace (`/robot/tf_static`); for a damaged bag those before the damage. Of several transforms
 * of a frame the last one counts, as in tf2.
 * \param conflicts gets a sentence for each frame with two parents or two poses, unless null */
[[nodiscard]] RosTransforms staticTransforms(Bag& bag,
                                             std::vector<std::string>* conflicts = nullptr);
/** The transforms of `/tf` that are the same in all messages of its first 10 s (at most 2000):
 * those of ROS 1's static_transform_publisher (package tf), which repeats them there, but also
 * those of joints that rest at first; for a damaged bag those before the damage. */
[[nodiscard]] RosTransforms constantTransforms(Bag& bag);
/** Transform T_a_b between two frames; nothing if the transforms do not connect them. */
[[nodiscard]] std::optional<Pose> transformBetween(const RosTransforms& transforms,
                                                   const std::string& a,
                                                   const std::string& b);
/** Base frame of a frame: base_link if that is among its ancestors in the transforms, else the
 * root; empty if it has no parent. */
[[nodiscard]] std::string baseFrameOf(const RosTransforms& transforms, const std::string& frame);
/** Frame of the header of a topic's first message, empty if there is none; "os_sensor", in which
 * their points are, of Ouster's packets.
 * \pre its messages begin with a header, or are such packets. */
[[nodiscard]] std::string frameOfTopic(Bag& bag, std::size_t topic);

/** Stamp of the header of a message; nothing if that is zero. \pre the message begins with a header
 * \throws UserError naming the message, if it is damaged. */
[[nodiscard]] std::optional<double> headerStampOf(const BagTopic& topic, const BagMessage& message);

/** A sample of an IMU, in the sensor's axes. */
struct RosImu
{
  double stamp = 0;   //!< of the header, else of the recording [s]
  std::string frame;  //!< frame_id of the header: the sensor's axes
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  //!< sensor's axes [rad/s]
  std::optional<Eigen::Vector3d> acceleration;  //!< with gravity, sensor's axes [m/s^2]
};
/** Whether a topic has `sensor_msgs/Imu`. */
[[nodiscard]] bool isRosImu(const BagTopic& topic);
/** Decodes an IMU message. Nothing if the angular velocity is unknown (its first covariance is -1)
 * or not a number; an unknown acceleration is left out. \throws UserError naming the message and
 * the problem. */
[[nodiscard]] std::optional<RosImu> decodeRosImu(const BagTopic& topic, const BagMessage& message);

/** A position of a satellite receiver. */
struct RosFix
{
  double stamp = 0;   //!< of the header, else of the recording [s]
  std::string frame;  //!< frame_id of the header: the antenna
  GeodeticPosition position;
  double horizontal_sigma = 0;  //!< sigma of east and of north [m]; 0: unknown
  double vertical_sigma = 0;    //!< sigma of the height [m]; 0: unknown
};
/** Whether a topic has `sensor_msgs/NavSatFix`. */
[[nodiscard]] bool isRosFix(const BagTopic& topic);
/** Decodes a position. Nothing if the receiver had no fix or the position is invalid.
 * \param swapped is increased by one for an invalid position that is valid with latitude and
 * longitude swapped, unless null
 * \throws UserError naming the message and the problem. */
[[nodiscard]] std::optional<RosFix> decodeRosFix(const BagTopic& topic,
                                                 const BagMessage& message,
                                                 std::size_t* swapped = nullptr);

/** Velocity of a body, in its axes. */
struct RosTwist
{
  double stamp = 0;   //!< of the header, else of the recording [s]
  std::string frame;  //!< frame of the body, whose axes the velocities are in
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   //!< velocity of the frame's origin [m/s]
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  //!< angular velocity [rad/s]
  std::optional<Pose> T_parent_body;                  //!< pose of an Odometry, if valid
};
/** Whether a topic has `nav_msgs/Odometry`, `geometry_msgs/TwistStamped` or
 * `TwistWithCovarianceStamped`. */
[[nodiscard]] bool isRosTwist(const BagTopic& topic);
/** Whether a topic has `nav_msgs/Odometry` with poses in the frame `map`: by REP 105
 * (https://www.ros.org/reps/rep-0105.html) the result of a localisation or of SLAM, as the wheels'
 * are in `odom`. Reads the first message. */
[[nodiscard]] bool isMapOdometry(Bag& bag, std::size_t topic);
/** Decodes a velocity. Nothing if it is not a number. \throws UserError naming the message and the
 * problem. */
[[nodiscard]] std::optional<RosTwist> decodeRosTwist(const BagTopic& topic,
                                                     const BagMessage& message);
}  // namespace dyslam
