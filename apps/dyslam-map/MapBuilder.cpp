// SPDX-License-Identifier: BSD-3-Clause
#include "MapBuilder.h"

#include <dyslam/core/Error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr double least_way = 1.0;  // an object that went farther than this from its start moves [m]

std::string labelFolder(const std::string& folder)
{
  if (folder.empty())
  {
    return folder;
  }
  const fs::path inner = fs::path(folder) / "labels";
  const std::string result = fs::is_directory(inner) ? inner.string() : folder;
  if (!fs::is_directory(result))
  {
    throw UserError(folder + ": is not a folder of .label files");
  }
  return result;
}

/** An upright box told in another frame; the tilt between them is left out. */
Box transformed(const Box& box, const Pose& T)
{
  Box result = box;
  result.center = T * box.center;
  const Eigen::Vector3d heading =
      T.linear() * Eigen::Vector3d(std::cos(box.yaw), std::sin(box.yaw), 0);
  result.yaw = std::atan2(heading.y(), heading.x());
  return result;
}
}  // namespace

MapBuilder::MapBuilder(const TrajectoryFile& trajectory, const MapBuilderOptions& options)
    : trajectory_(trajectory),
      options_(options),
      label_folder_(labelFolder(options.labels)),
      pool_(options.threads),
      preprocessor_(options.preprocess, pool_),
      map_(options.map)
{
  if (trajectory_.trajectory.empty())
  {
    throw UserError("the trajectory has no poses");
  }
  if (options_.tracks.empty())
  {
    return;
  }
  for (const auto& box : readTracks(options_.tracks))
  {
    boxes_.emplace(box.frame, box);
    moves_[box.id] = false;
  }
}

std::optional<std::size_t> MapBuilder::poseOf(const Frame& frame) const
{
  if (trajectory_.format == TrajectoryFormat::tum)
  {
    return trajectory_.trajectory.nearest(frame.scan.stamp, options_.tolerance);
  }
  return frame.index < trajectory_.trajectory.size() ? std::optional(frame.index) : std::nullopt;
}

bool MapBuilder::isKeyframe(const Pose& T_map_vehicle) const
{
  if (!last_keyframe_)
  {
    return true;
  }
  const Pose moved = last_keyframe_->inverse() * T_map_vehicle;
  return moved.translation().norm() >= options_.keyframe_distance ||
         rotationAngle(moved) >= options_.keyframe_angle;
}

void MapBuilder::fillCloud(Frame& frame, std::size_t pose) const
{
  const Trajectory& t = trajectory_.trajectory;
  Pose T_previous_current = Pose::Identity();
  double dt = 0;
  if (t.size() > 1)
  {
    const std::size_t current = std::max<std::size_t>(pose, 1);
    T_previous_current = t[current - 1].pose.inverse() * t[current].pose;
    // A KITTI file has no times: one scan a revolution, at the usual 10 Hz.
    constexpr double usual_period = 0.1;
    dt = trajectory_.format == TrajectoryFormat::tum ? t[current].stamp - t[current - 1].stamp
                                                     : usual_period;
  }
  frame.cloud = preprocessor_.prepare(frame.scan, T_previous_current, dt);
}

/** One label per point of the cloud. */
std::vector<Label> MapBuilder::labelsOf(const Frame& frame) const
{
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.label", frame.index);
  const std::string path = (fs::path(label_folder_) / name).string();
  const auto labels = readLabels(path, frame.scan.size());
  std::vector<Label> result;
  result.reserve(frame.cloud.size());
  for (const auto i : frame.cloud.source)
  {
    result.push_back(labels[i]);
  }
  return result;
}

void MapBuilder::fillMoving(Frame& frame) const
{
  if (!label_folder_.empty())
  {
    for (const Label label : labelsOf(frame))
    {
      const bool moving = isMoving(label) || semanticOf(label) == semanticOf(label_moving);
      frame.moving_probability.push_back(moving ? 1.0F : 0.0F);
    }
  }
  const auto [begin, end] = boxes_.equal_range(static_cast<int>(frame.index));
  for (auto it = begin; it != end; ++it)
  {
    TrackedObject object;
    object.id = it->second.id;
    object.box = transformed(it->second.box, frame.T_odom_vehicle * frame.scan.T_vehicle_lidar);
    object.object_class = it->second.object_class;
    object.dynamic = moves_.at(object.id);
    frame.objects.push_back(object);
  }
}

void MapBuilder::noteObjects(const Frame& frame)
{
  const auto [begin, end] = boxes_.equal_range(static_cast<int>(frame.index));
  for (auto it = begin; it != end; ++it)
  {
    LabelledBox box = it->second;
    box.box = transformed(box.box, frame.T_odom_vehicle * frame.scan.T_vehicle_lidar);
    auto& path = object_paths_[box.id];
    path.push_back(box.box.center);
    last_boxes_[box.id] = box;
    moves_[box.id] = moves_[box.id] || (path.back() - path.front()).norm() > least_way;
  }
}

void MapBuilder::collectLabelled(const Frame& frame)
{
  std::vector<Label> labels = label_folder_.empty()
                                  ? std::vector<Label>(frame.cloud.size(), label_static)
                                  : labelsOf(frame);
  constexpr double margin = 0.1;
  for (const auto& object : frame.objects)
  {
    for (std::size_t i = 0; i < labels.size() && object.dynamic; ++i)
    {
      const Eigen::Vector3d p = frame.T_odom_vehicle * frame.cloud.points[i].cast<double>();
      const Eigen::Vector3d d =
          Eigen::AngleAxisd(-object.box.yaw, Eigen::Vector3d::UnitZ()) * (p - object.box.center);
      const Eigen::Vector3d half = 0.5 * object.box.size + Eigen::Vector3d(margin, margin, 0.0);
      // What touches the ground is the ground.
      if ((d.cwiseAbs() - half).maxCoeff() <= 0 && d.z() > 0.25 - half.z())
      {
        labels[i] = label_moving;
      }
    }
  }
  const auto inverse = static_cast<float>(1.0 / options_.labelled_voxel);
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    if (isIgnored(labels[i]))
    {
      continue;
    }
    const Eigen::Vector3f p =
        (frame.T_odom_vehicle * frame.cloud.points[i].cast<double>()).cast<float>();
    const auto next = static_cast<std::uint32_t>(labelled_.points.size());
    const auto found = labelled_index_.findOrInsert(voxelKey(voxelCell(p, inverse)), next);
    const bool moving = isMoving(labels[i]) || semanticOf(labels[i]) == semanticOf(label_moving);
    if (found == next)
    {
      labelled_.points.push_back(p);
      labelled_.labels.push_back(labels[i]);
    }
    else if (!moving)
    {
      labelled_.labels[found] = labels[i];
    }
  }
}

void MapBuilder::add(Frame frame)
{
  const auto pose = poseOf(frame);
  if (!pose)
  {
    ++skipped_;
    return;
  }
  frame.T_odom_vehicle = trajectory_.trajectory[*pose].pose;
  noteObjects(frame);
  if (!isKeyframe(frame.T_odom_vehicle))
  {
    return;
  }
  last_keyframe_ = frame.T_odom_vehicle;
  fillCloud(frame, *pose);
  fillMoving(frame);
  if (options_.labelled_map)
  {
    collectLabelled(frame);
  }
  map_.insert(frame);
}

SceneContent MapBuilder::scene() const
{
  SceneContent scene;
  const MapPoints points = map_.points();
  scene.points = points.points;
  scene.intensity = points.intensity;
  scene.trajectory = trajectory_.trajectory;
  for (const auto& [id, path] : object_paths_)
  {
    if (moves_.at(id))
    {
      scene.object_paths.push_back(path);
      scene.boxes.push_back(last_boxes_.at(id));
    }
  }
  return scene;
}
}  // namespace dyslam
