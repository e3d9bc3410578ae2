// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RosWriter.h>

#include <Eigen/Geometry>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "CdrWriter.h"

namespace dyslam
{
namespace
{
constexpr std::uint64_t second_in_ns = 1000000000;

void putStamp(CdrWriter& out, double stamp)
{
  const std::uint64_t nanoseconds = rosNanoseconds(stamp);
  out.put(static_cast<std::int32_t>(nanoseconds / second_in_ns));
  out.put(static_cast<std::uint32_t>(nanoseconds % second_in_ns));
}

void putHeader(CdrWriter& out, double stamp, const std::string& frame)
{
  putStamp(out, stamp);
  out.text(frame);
}

void putVector3(CdrWriter& out, const Eigen::Vector3d& vector)
{
  out.put(vector.x()).put(vector.y()).put(vector.z());
}

/** Position and quaternion, x first: Pose and Transform are the same in CDR. */
void putPose(CdrWriter& out, const Pose& pose)
{
  const Eigen::Quaterniond q(pose.rotation());
  putVector3(out, pose.translation());
  out.put(q.x()).put(q.y()).put(q.z()).put(q.w());
}

/** A covariance matrix that is zero beside these first numbers of its diagonal. */
void putCovariance(CdrWriter& out, std::size_t size, std::initializer_list<double> diagonal = {})
{
  for (std::size_t row = 0; row < size; ++row)
  {
    for (std::size_t column = 0; column < size; ++column)
    {
      const bool given = row == column && row < diagonal.size();
      out.put(given ? *(diagonal.begin() + row) : 0.0);
    }
  }
}

void putCovariance(CdrWriter& out, const Matrix6& covariance)
{
  for (Eigen::Index row = 0; row < covariance.rows(); ++row)
  {
    for (Eigen::Index column = 0; column < covariance.cols(); ++column)
    {
      out.put(covariance(row, column));
    }
  }
}

/** A PointField of one number. */
struct WrittenField
{
  const char* name;
  std::uint8_t type;  //!< 2 uint8, 4 uint16, 7 float32
  std::uint32_t size;
};

std::vector<WrittenField> messageFields(const Scan& scan, bool with_moving)
{
  std::vector<WrittenField> fields{{"x", 7, 4}, {"y", 7, 4}, {"z", 7, 4}};
  if (!scan.intensity.empty())
  {
    fields.push_back({"intensity", 7, 4});
  }
  if (!scan.ring.empty())
  {
    fields.push_back({"ring", 4, 2});
  }
  if (!scan.time.empty())
  {
    fields.push_back({"time", 7, 4});
  }
  if (with_moving)
  {
    fields.push_back({"moving", 2, 1});
  }
  return fields;
}

/** The points of a cloud, packed without gaps. */
struct MessagePoints
{
  std::string data;
  std::size_t points = 0;
  bool all_finite = true;
};

MessagePoints messagePoints(const Scan& scan,
                            const std::vector<bool>& moving,
                            MovingPoints treatment,
                            std::size_t point_size)
{
  MessagePoints cloud;
  cloud.data.reserve(scan.size() * point_size);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const bool moves = i < moving.size() && moving[i];
    if (moves && treatment == MovingPoints::left_out)
    {
      continue;
    }
    const Eigen::Vector3f& point = scan.points[i];
    cloud.all_finite = cloud.all_finite && point.allFinite();
    ++cloud.points;
    for (const float coordinate : {point.x(), point.y(), point.z()})
    {
      appendBytes(cloud.data, coordinate);
    }
    if (!scan.intensity.empty())
    {
      appendBytes(cloud.data, scan.intensity[i]);
    }
    if (!scan.ring.empty())
    {
      appendBytes(cloud.data, scan.ring[i]);
    }
    if (!scan.time.empty())
    {
      appendBytes(cloud.data, scan.time[i]);
    }
    if (!moving.empty() && treatment == MovingPoints::as_field)
    {
      appendBytes(cloud.data, static_cast<std::uint8_t>(moves ? 1 : 0));
    }
  }
  return cloud;
}

void putMarker(CdrWriter& out,
               double stamp,
               const std::string& frame,
               const RosMarker& marker,
               std::int32_t action)
{
  putHeader(out, stamp, frame);
  out.text(marker.group).put(static_cast<std::int32_t>(marker.id));
  out.put(static_cast<std::int32_t>(marker.shape)).put(action);
  putPose(out, marker.pose);
  putVector3(out, marker.scale);
  for (const float part : marker.colour)
  {
    out.put(part);
  }
  out.put(std::int32_t{0}).put(std::uint32_t{0});  // lifetime: until it is replaced
  out.put(std::uint8_t{0});                        // not locked to a moving frame
  out.count(marker.points.size());
  for (const Eigen::Vector3d& point : marker.points)
  {
    putVector3(out, point);
  }
  out.count(0);  // colours of the points
  out.text("");  // texture: its name, then the image with header and format
  out.put(std::int32_t{0}).put(std::uint32_t{0}).text("").text("").block("");
  out.count(0);                                 // texture coordinates
  out.text(marker.text).text("");               // of no mesh
  out.text("").block("").put(std::uint8_t{0});  // file of the mesh, and its materials
}
}  // namespace

std::uint64_t rosNanoseconds(double stamp)
{
  constexpr double end = 2147483648.0;  // int32 holds no later second
  if (!(stamp >= 0 && stamp < end - 1))
  {
    throw UserError("the time stamp " + formatted("%.3f", stamp) +
                    " s is none that ROS 2 holds, from 0 to 2147483646 s after 1970");
  }
  const double whole = std::floor(stamp);
  return static_cast<std::uint64_t>(whole) * second_in_ns +
         static_cast<std::uint64_t>(std::llround((stamp - whole) * 1e9));
}

std::string cloudMessage(const Scan& scan,
                         const std::string& frame,
                         const std::vector<bool>& moving,
                         MovingPoints treatment)
{
  const std::vector<WrittenField> fields =
      messageFields(scan, !moving.empty() && treatment == MovingPoints::as_field);
  std::uint32_t step = 0;
  for (const WrittenField& field : fields)
  {
    step += field.size;
  }
  const MessagePoints cloud = messagePoints(scan, moving, treatment, step);
  if (cloud.data.size() > std::numeric_limits<std::uint32_t>::max())
  {
    throw UserError("a cloud of " + counted(cloud.points, "point") + " has " +
                    counted(cloud.data.size(), "byte") +
                    ", and a message of ROS 2 holds 4294967295: make it smaller");
  }
  CdrWriter out;
  constexpr std::size_t head = 1000;  // enough for header and fields [bytes]
  out.reserve(cloud.data.size() + head);
  putHeader(out, scan.stamp, frame);
  out.put(std::uint32_t{1}).put(static_cast<std::uint32_t>(cloud.points));
  out.count(fields.size());
  std::uint32_t offset = 0;
  for (const WrittenField& field : fields)
  {
    out.text(field.name).put(offset).put(field.type).put(std::uint32_t{1});
    offset += field.size;
  }
  out.put(std::uint8_t{0}).put(step).put(static_cast<std::uint32_t>(cloud.data.size()));
  out.block(cloud.data).put(static_cast<std::uint8_t>(cloud.all_finite ? 1 : 0));
  return out.take();
}

std::string imuMessage(const RosImu& imu)
{
  constexpr double unknown = -1;
  CdrWriter out;
  putHeader(out, imu.stamp, imu.frame);
  out.put(0.0).put(0.0).put(0.0).put(1.0);
  putCovariance(out, 3, {unknown});
  putVector3(out, imu.angular_velocity);
  putCovariance(out, 3);
  putVector3(out, imu.acceleration.value_or(Eigen::Vector3d::Zero()));
  imu.acceleration ? putCovariance(out, 3) : putCovariance(out, 3, {unknown});
  return out.take();
}

std::string fixMessage(const RosFix& fix)
{
  constexpr std::uint8_t diagonal_known = 2;
  const double horizontal = fix.horizontal_sigma * fix.horizontal_sigma;
  const double vertical = fix.vertical_sigma * fix.vertical_sigma;
  const bool known = horizontal > 0 && vertical > 0;
  CdrWriter out;
  putHeader(out, fix.stamp, fix.frame);
  out.put(std::int8_t{0}).put(std::uint16_t{1});  // a fix, by GPS
  out.put(fix.position.latitude).put(fix.position.longitude).put(fix.position.height);
  known ? putCovariance(out, 3, {horizontal, horizontal, vertical}) : putCovariance(out, 3);
  out.put(known ? diagonal_known : std::uint8_t{0});
  return out.take();
}

std::string twistMessage(const RosTwist& twist)
{
  CdrWriter out;
  putHeader(out, twist.stamp, twist.frame);
  putVector3(out, twist.linear);
  putVector3(out, twist.angular);
  return out.take();
}

std::string poseMessage(const RosPose& pose)
{
  CdrWriter out;
  putHeader(out, pose.stamp, pose.parent);
  putPose(out, pose.pose);
  return out.take();
}

std::string odometryMessage(const RosPose& pose,
                            const RosTwist& twist,
                            const RosOdometryCovariances& covariances)
{
  CdrWriter out;
  putHeader(out, pose.stamp, pose.parent);
  out.text(pose.child);
  putPose(out, pose.pose);
  putCovariance(out, covariances.pose);
  putVector3(out, twist.linear);
  putVector3(out, twist.angular);
  putCovariance(out, covariances.twist);
  return out.take();
}

std::string pathMessage(double stamp, const std::string& frame, const Trajectory& poses)
{
  CdrWriter out;
  putHeader(out, stamp, frame);
  out.count(poses.size());
  for (const StampedPose& pose : poses)
  {
    putHeader(out, pose.stamp, frame);
    putPose(out, pose.pose);
  }
  return out.take();
}

std::string transformsMessage(const std::vector<RosPose>& transforms)
{
  CdrWriter out;
  out.count(transforms.size());
  for (const RosPose& transform : transforms)
  {
    putHeader(out, transform.stamp, transform.parent);
    out.text(transform.child);
    putPose(out, transform.pose);
  }
  return out.take();
}

std::string markersMessage(double stamp,
                           const std::string& frame,
                           const std::vector<RosMarker>& markers)
{
  constexpr std::int32_t add = 0;
  constexpr std::int32_t delete_all = 3;
  CdrWriter out;
  out.count(markers.size() + 1);
  putMarker(out, stamp, frame, RosMarker(), delete_all);
  for (const RosMarker& marker : markers)
  {
    putMarker(out, stamp, frame, marker, add);
  }
  return out.take();
}
}  // namespace dyslam
