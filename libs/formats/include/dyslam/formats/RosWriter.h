// SPDX-License-Identifier: BSD-3-Clause
// Messages of ROS 2 in CDR, and the definitions of their types, for a BagWriter.
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/RosMessages.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Types of the messages that are written. */
enum class RosType
{
  point_cloud2,   //!< sensor_msgs/msg/PointCloud2
  imu,            //!< sensor_msgs/msg/Imu
  nav_sat_fix,    //!< sensor_msgs/msg/NavSatFix
  twist_stamped,  //!< geometry_msgs/msg/TwistStamped
  pose_stamped,   //!< geometry_msgs/msg/PoseStamped
  odometry,       //!< nav_msgs/msg/Odometry
  path,           //!< nav_msgs/msg/Path
  transforms,     //!< tf2_msgs/msg/TFMessage
  marker_array    //!< visualization_msgs/msg/MarkerArray
};

/** Name of a type as ROS 2 spells it: "sensor_msgs/msg/PointCloud2". */
[[nodiscard]] std::string rosTypeName(RosType type);
/** Definition of a type and of all types in it, as of ROS 2 Humble, without comments: the schema
 * `ros2msg` of mcap files. */
[[nodiscard]] std::string rosDefinition(RosType type);

/** Nanoseconds since 1970 of a stamp [s], to the nearest. \throws UserError for a stamp that a
 * header of ROS 2 does not hold: before 1970, from 2038 on, or not a number. */
[[nodiscard]] std::uint64_t rosNanoseconds(double stamp);

/** What a cloud shows of the points that are marked as moving. */
enum class MovingPoints
{
  as_field,  //!< a field `moving`, 1 or 0
  left_out   //!< these points are left out
};

/** PointCloud2 of a scan, one row: x y z and, where the scan has them, intensity (float32), ring
 * (uint16) and time (float32, seconds from the stamp), as Velodyne's driver names them; then moving
 * (uint8). Points without a return are kept as they are.
 * \param moving one per point; empty: none is known \throws UserError as rosNanoseconds(), and for
 * more points than a message holds. */
[[nodiscard]] std::string cloudMessage(const Scan& scan,
                                       const std::string& frame,
                                       const std::vector<bool>& moving = {},
                                       MovingPoints treatment = MovingPoints::as_field);

// The following messages have the stamps of their values. All throw UserError as rosNanoseconds().

/** Imu without orientation; an acceleration that is not there is marked as unknown. */
[[nodiscard]] std::string imuMessage(const RosImu& imu);
/** NavSatFix with a fix; without sigmas its covariance is unknown. */
[[nodiscard]] std::string fixMessage(const RosFix& fix);
/** TwistStamped in `RosTwist::frame`. */
[[nodiscard]] std::string twistMessage(const RosTwist& twist);
/** PoseStamped in the parent frame. */
[[nodiscard]] std::string poseMessage(const RosPose& pose);
/** Covariances of an Odometry, of translation and rotation [m, rad, m/s, rad/s]; zero where they
 * are not known. */
struct RosOdometryCovariances
{
  Matrix6 pose = Matrix6::Zero();   //!< in the axes of the parent frame, also of the rotation
  Matrix6 twist = Matrix6::Zero();  //!< in the axes of the child
};
/** Odometry. \param twist velocity of the child, in its axes; only its vectors are used */
[[nodiscard]] std::string odometryMessage(const RosPose& pose,
                                          const RosTwist& twist,
                                          const RosOdometryCovariances& covariances = {});
/** Path of stamped poses. */
[[nodiscard]] std::string pathMessage(double stamp,
                                      const std::string& frame,
                                      const Trajectory& poses);
/** TFMessage. */
[[nodiscard]] std::string transformsMessage(const std::vector<RosPose>& transforms);

/** A shape that RViz and Foxglove draw. */
struct RosMarker
{
  enum class Shape : std::int32_t
  {
    arrow = 0,  //!< from the first of `points` to the second
    cube = 1,
    text = 9  //!< faces the viewer
  };
  std::string group;  //!< namespace of its id
  int id = 0;
  Shape shape = Shape::cube;
  Pose pose = Pose::Identity();                     //!< in the frame of the message
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  //!< as of visualization_msgs/Marker [m]
  std::array<float, 4> colour{1, 1, 1, 1};          //!< red, green, blue, opacity
  std::vector<Eigen::Vector3d> points;              //!< of an arrow
  std::string text;
};
/** MarkerArray that replaces all shapes of its topic: the first marker deletes the earlier ones. */
[[nodiscard]] std::string markersMessage(double stamp,
                                         const std::string& frame,
                                         const std::vector<RosMarker>& markers);
}  // namespace dyslam
