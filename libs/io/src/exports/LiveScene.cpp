// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/io/LiveScene.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/stock_objects.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "SceneParts.h"

namespace dyslam
{
using mrpt::img::TColor;

namespace
{
constexpr double part_length = 10;      // way on which a part of the map grows [m]
constexpr std::size_t most_parts = 20;  // parts shown
constexpr float voxel_size = 0.25F;     // of the map [m]
constexpr std::size_t most_positions = 4000;
const TColor moving_colour(255, 40, 40);
const TColor path_colour(255, 255, 255);
const mrpt::img::TColorf background(0.05F, 0.05F, 0.08F);

/** Static points seen on a part of the way, one per voxel, in the odometry frame. */
struct MapPart
{
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();  //!< position of the vehicle [m]
  VoxelHash voxels;
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;
  mrpt::opengl::CPointCloudColoured::Ptr drawn;  //!< null while the part grows
};

/** "scan 120, 12.0 s, 8.3 m/s, 5 moving objects". \param seconds since the first scan */
std::string statusOf(const Frame& frame, double seconds)
{
  const auto moving = static_cast<std::size_t>(
      std::count_if(frame.objects.begin(), frame.objects.end(),
                    [](const TrackedObject& o) { return o.reported && o.dynamic; }));
  const double speed =
      frame.dt > 0 ? frame.motion.T_previous_current.translation().norm() / frame.dt : 0;
  return formatted("scan %zu, %.1f s, %.1f m/s, %s", frame.index, seconds, speed,
                   counted(moving, "moving object").c_str());
}

/** The points of the frame's cloud that are moving, in the odometry frame. */
std::vector<Eigen::Vector3f> movingPoints(const Frame& frame)
{
  const Eigen::Isometry3f T_odom_vehicle = frame.T_odom_vehicle.cast<float>();
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < frame.moving.size(); ++i)
  {
    if (frame.moving[i])
    {
      points.emplace_back(T_odom_vehicle * frame.cloud.points[i]);
    }
  }
  return points;
}
}  // namespace

struct LiveScene::Impl
{
  std::optional<std::size_t> last_index;
  double first_time = 0;  //!< of the first frame [s]
  std::vector<Eigen::Vector3d> path;
  std::deque<MapPart> parts;
  /** Of the first frame with static points, relative to the vehicle [m]. */
  std::optional<HeightRange> heights;

  void addPosition(const Eigen::Vector3d& position)
  {
    path.push_back(position);
    if (path.size() > most_positions)
    {
      // Every other position, and the newest one.
      std::vector<Eigen::Vector3d> halved;
      for (std::size_t i = 0; i < path.size(); i += 2)
      {
        halved.push_back(path[i]);
      }
      halved.back() = position;
      path = std::move(halved);
    }
  }

  [[nodiscard]] mrpt::opengl::CPointCloudColoured::Ptr draw(const MapPart& part) const
  {
    const auto z = static_cast<float>(part.begin.z());
    const HeightRange range = heights.value_or(HeightRange());
    return heightColoured(part.points, part.intensity, {range.low + z, range.high + z}, 2.0F);
  }

  /** The part that grows; where the vehicle has left the last one, a new one. */
  MapPart& growingPart()
  {
    if (!parts.empty() && (path.back() - parts.back().begin).norm() <= part_length)
    {
      return parts.back();
    }
    if (!parts.empty())
    {
      MapPart complete;
      complete.drawn = draw(parts.back());
      parts.back() = std::move(complete);
    }
    if (parts.size() == most_parts)
    {
      parts.pop_front();
    }
    parts.emplace_back().begin = path.back();
    return parts.back();
  }

  void addStaticPoints(const Frame& frame)
  {
    MapPart& part = growingPart();
    const Eigen::Isometry3f T_odom_vehicle = frame.T_odom_vehicle.cast<float>();
    const bool has_intensity = frame.cloud.intensity.size() == frame.cloud.size();
    for (std::size_t i = 0; i < frame.cloud.size(); ++i)
    {
      const Eigen::Vector3f p = T_odom_vehicle * frame.cloud.points[i];
      if (frame.isMoving(i) || !p.allFinite())
      {
        continue;
      }
      const auto next = static_cast<std::uint32_t>(part.points.size());
      if (part.voxels.findOrInsert(voxelKey(voxelCell(p, 1 / voxel_size)), next) == next)
      {
        part.points.push_back(p);
        part.intensity.push_back(has_intensity ? frame.cloud.intensity[i] : 0.5F);
      }
    }
    if (!heights && !part.points.empty())
    {
      const auto z = static_cast<float>(part.begin.z());
      const HeightRange range = heightRange(part.points);
      // Red is left to the moving points.
      heights = HeightRange{range.low - z, range.low - z + 1.7F * (range.high - range.low)};
    }
  }

  [[nodiscard]] mrpt::opengl::COpenGLScene::Ptr draw(const Frame& frame) const
  {
    auto scene = mrpt::opengl::COpenGLScene::Create();
    for (const MapPart& part : parts)
    {
      scene->insert(part.drawn ? part.drawn : draw(part));
    }
    const bool has_pose = frame.T_odom_vehicle.matrix().allFinite();
    if (has_pose)
    {
      scene->insert(plainColoured(movingPoints(frame), moving_colour, 4.0F));
      const auto vehicle = mrpt::opengl::stock_objects::CornerXYZSimple(2.0F, 3.0F);
      vehicle->setPose(toMrpt(frame.T_odom_vehicle));
      scene->insert(vehicle);
    }
    for (const TrackedObject& object : frame.objects)
    {
      if (object.reported)
      {
        insertObject(*scene, object, Pose::Identity());
      }
    }
    if (const auto line = polyline(path, path_colour, 3.0F))
    {
      scene->insert(line);
    }
    scene->getViewport()->setCustomBackgroundColor(background);
    scene->getViewport()->addTextMessage(10, 10, statusOf(frame, frame.time() - first_time));
    return scene;
  }
};

LiveScene::LiveScene() : impl_(std::make_unique<Impl>()) {}
LiveScene::~LiveScene() = default;
LiveScene::LiveScene(LiveScene&&) noexcept = default;
LiveScene& LiveScene::operator=(LiveScene&&) noexcept = default;

std::shared_ptr<mrpt::opengl::COpenGLScene> LiveScene::add(const Frame& frame)
{
  if (impl_->last_index && frame.index <= *impl_->last_index)
  {
    *impl_ = Impl();
  }
  Impl& m = *impl_;
  if (!m.last_index)
  {
    m.first_time = frame.time();
  }
  if (frame.T_odom_vehicle.matrix().allFinite())
  {
    m.addPosition(frame.T_odom_vehicle.translation());
    m.addStaticPoints(frame);
  }
  m.last_index = frame.index;
  return m.draw(frame);
}

Eigen::Vector3d LiveScene::vehiclePosition() const
{
  return impl_->path.empty() ? Eigen::Vector3d::Zero() : impl_->path.back();
}
}  // namespace dyslam
