// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/Pose.h>
#include <dyslam/formats/RosWriter.h>
#include <dyslam/io/LiveTopics.h>
#include <dyslam/ros2/Ros2Domain.h>

#include <Eigen/Cholesky>
#include <string>
#include <utility>
#include <vector>

#include "ObjectMarkers.h"

namespace dyslam
{
namespace
{
constexpr const char* map_frame = "map";
constexpr const char* flag = "--publish";

/** The static points of the cloud, deskewed, in the recording's vehicle frame. */
Scan staticPoints(const Frame& frame, const Pose& T_recorded_level)
{
  const Eigen::Isometry3f T = T_recorded_level.cast<float>();
  const bool has_intensity = frame.cloud.intensity.size() == frame.cloud.size();
  Scan points;
  points.stamp = frame.scan.stamp;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (frame.isMoving(i))
    {
      continue;
    }
    points.points.emplace_back(T * frame.cloud.points[i]);
    if (has_intensity)
    {
      points.intensity.push_back(frame.cloud.intensity[i]);
    }
  }
  return points;
}

std::vector<RosMarker> markersOf(const Frame& frame)
{
  std::vector<RosMarker> markers;
  for (const TrackedObject& object : frame.objects)
  {
    if (object.reported)
    {
      addMarkers({object.id, toString(object.object_class),
                  transformedBack(object.box, frame.T_map_odom.inverse()),
                  frame.T_map_odom.linear() * object.velocity, object.dynamic},
                 markers);
    }
  }
  return markers;
}
}  // namespace

struct LiveTopics::Impl
{
  explicit Impl(LiveTopicsOptions options_in)
      : options(std::move(options_in)),
        domain(openRos2Domain(flag, Ros2DomainOptions::fromEnvironment())),
        odometry(advertise("/dyslam/odometry", RosType::odometry)),
        points(advertise("/dyslam/points_static", RosType::point_cloud2)),
        objects(advertise("/dyslam/objects", RosType::marker_array))
  {
    if (options.transforms)
    {
      constexpr std::size_t depth = 100;  // as that of tf2's broadcasters
      transforms = domain->advertise({"/tf", rosTypeName(RosType::transforms), false, true, depth});
    }
  }

  [[nodiscard]] std::unique_ptr<Ros2Publisher> advertise(const char* topic, RosType type) const
  {
    return domain->advertise({topic, rosTypeName(type)});
  }

  /** \param pose T_map_vehicle of the recording's vehicle */
  [[nodiscard]] std::string odometryOf(const Frame& frame, const RosPose& pose) const
  {
    RosTwist twist;
    RosOdometryCovariances covariances;
    if (frame.dt > 0)
    {
      const Pose T_level_recorded = levelling.T_level_recorded();
      const Pose motion =
          T_level_recorded.inverse() * frame.motion.T_previous_current * T_level_recorded;
      const Vector6 velocity = logSE3(motion) / frame.dt;
      twist.linear = velocity.head<3>();
      twist.angular = velocity.tail<3>();
      const Eigen::LLT<Matrix6> cholesky(frame.motion.information);
      if (cholesky.info() == Eigen::Success)
      {
        const Matrix6 turn = adjointSE3(T_level_recorded.inverse());
        covariances.twist =
            turn * cholesky.solve(Matrix6::Identity()) * turn.transpose() / (frame.dt * frame.dt);
      }
    }
    return odometryMessage(pose, twist, covariances);
  }

  LiveTopicsOptions options;
  Levelling levelling;
  std::unique_ptr<Ros2Domain> domain;
  std::unique_ptr<Ros2Publisher> odometry;
  std::unique_ptr<Ros2Publisher> points;
  std::unique_ptr<Ros2Publisher> objects;
  std::unique_ptr<Ros2Publisher> transforms;  //!< null: none
};

LiveTopics::LiveTopics(const LiveTopicsOptions& options) : impl_(std::make_unique<Impl>(options)) {}

LiveTopics::~LiveTopics() = default;

void LiveTopics::setVehicleFrame(const std::string& name)
{
  impl_->options.vehicle_frame = name;
}

void LiveTopics::setLevelling(const Levelling& levelling)
{
  impl_->levelling = levelling;
}

void LiveTopics::publish(const Frame& frame)
{
  const Impl& m = *impl_;
  const double stamp = frame.scan.stamp;
  const RosPose pose{stamp, map_frame, m.options.vehicle_frame,
                     m.levelling.recorded(frame.T_map_vehicle())};
  if (!pose.pose.matrix().allFinite())
  {
    return;
  }
  if (m.transforms)
  {
    m.transforms->publish(transformsMessage({pose}));
  }
  m.odometry->publish(m.odometryOf(frame, pose));
  if (m.points->subscriptions() > 0)
  {
    const Pose T_recorded_level = m.levelling.T_level_recorded().inverse();
    m.points->publish(cloudMessage(staticPoints(frame, T_recorded_level), pose.child));
  }
  if (m.objects->subscriptions() > 0)
  {
    m.objects->publish(markersMessage(stamp, map_frame, markersOf(frame)));
  }
}
}  // namespace dyslam
