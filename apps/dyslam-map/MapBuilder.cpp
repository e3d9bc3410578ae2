// SPDX-License-Identifier: BSD-3-Clause
#include "MapBuilder.h"

#include <dyslam/core/Labels.h>

#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double keyframe_angle = 0.17;  // a scan is used after this rotation [rad]
constexpr double labelled_voxel = 0.1;   // of the labelled map [m]

/** Whole kilometres of where the trajectory starts, if that is far from zero. */
Eigen::Vector3d originOf(const Trajectory& trajectory)
{
  constexpr double far = 10000;
  constexpr double step = 1000;
  const Eigen::Vector3d start = trajectory[0].pose.translation();
  if (!start.allFinite() || start.norm() <= far)
  {
    return Eigen::Vector3d::Zero();
  }
  return step * (start / step).array().floor();
}

Trajectory relativeTo(const Eigen::Vector3d& origin, const Trajectory& trajectory)
{
  Trajectory result;
  for (const auto& [stamp, pose] : trajectory)
  {
    result.push_back(stamp, Eigen::Translation3d(-origin) * pose);
  }
  return result;
}

/** Options without any cleaning. */
StaticMapOptions uncleaned(StaticMapOptions options)
{
  options.visibility = false;
  options.min_hits = 1;
  return options;
}
}  // namespace

MapBuilder::MapBuilder(const MapBuilderOptions& options)
    : options_(options),
      pool_(options.threads),
      memory_(MemoryLimit(options.memory, options.temporary_folder)
                  .part(options.uncleaned_map ? 0.5 : 1.0)),
      keyframes_(memory_),
      map_(options.map, keyframes_)
{
  if (!options_.scan_store.empty())
  {
    scans_.emplace(options_.scan_store, options_.map);
  }
  if (options_.uncleaned_map)
  {
    uncleaned_ = std::make_unique<Uncleaned>(uncleaned(options_.map), memory_);
  }
}

void MapBuilder::beginRun(const Trajectory& trajectory, const RunScansOptions& options)
{
  finish();
  if (runs_.empty())
  {
    origin_ = trajectory.empty() ? origin_ : originOf(trajectory);
  }
  else
  {
    map_.beginRun();
    if (scans_)
    {
      scans_->beginRun();
    }
  }
  runs_.emplace_back(relativeTo(origin_, trajectory), options, pool_);
  last_keyframe_.reset();
  hindsight_.reset();
  if (options_.hindsight.hindsight && !runs_.back().hasLabels())
  {
    hindsight_.emplace(options_.hindsight, options_.threads);
  }
}

bool MapBuilder::isKeyframe(const Pose& T_map_vehicle) const
{
  if (!last_keyframe_)
  {
    return true;
  }
  const Pose moved = last_keyframe_->inverse() * T_map_vehicle;
  return moved.translation().norm() >= options_.keyframe_distance ||
         rotationAngle(moved) >= keyframe_angle;
}

void MapBuilder::collectLabelled(const Frame& frame)
{
  std::vector<Label> labels = runs_.back().hasLabels()
                                  ? runs_.back().labelsOf(frame)
                                  : std::vector<Label>(frame.cloud.size(), label_static);
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
  const auto inverse = static_cast<float>(1.0 / labelled_voxel);
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    if (isIgnoredLabel(labels[i]))
    {
      continue;
    }
    const Eigen::Vector3f p =
        (frame.T_odom_vehicle * frame.cloud.points[i].cast<double>()).cast<float>();
    const auto next = static_cast<std::uint32_t>(labelled_.points.size());
    const auto found = labelled_index_.findOrInsert(voxelKey(voxelCell(p, inverse)), next);
    if (found == next)
    {
      labelled_.points.push_back(p);
      labelled_.labels.push_back(labels[i]);
    }
    else if (!isMovingLabel(labels[i]))
    {
      labelled_.labels[found] = labels[i];
    }
  }
}

void MapBuilder::add(Frame frame)
{
  RunScans& run = runs_.back();
  const auto pose = run.poseOf(frame);
  if (!pose)
  {
    ++skipped_;
    return;
  }
  frame.T_odom_vehicle = run.trajectory()[*pose].pose;
  frame.is_keyframe = isKeyframe(frame.T_odom_vehicle);
  if (!frame.is_keyframe && !hindsight_)
  {
    return;
  }
  run.fillCloud(frame, *pose);
  if (frame.is_keyframe)
  {
    last_keyframe_ = frame.T_odom_vehicle;
    run.fillMoving(frame);
    if (options_.labelled_map)
    {
      collectLabelled(frame);
    }
    keyframes_.add(keyframeOf(frame));
  }
  if (!hindsight_)
  {
    insert(frame);
    return;
  }
  const bool wanted = frame.is_keyframe;
  hindsight_->add(std::move(frame), wanted, [this](const Frame& f) { insert(f); });
}

void MapBuilder::insert(const Frame& frame)
{
  if (!frame.is_keyframe)
  {
    return;
  }
  if (options_.whole_map)
  {
    map_.insert(frame);
  }
  if (scans_)
  {
    scans_->add(frame);
  }
  if (uncleaned_)
  {
    Frame all;
    all.index = frame.index;
    all.scan.stamp = frame.scan.stamp;
    all.scan.T_vehicle_lidar = frame.scan.T_vehicle_lidar;
    all.T_odom_vehicle = frame.T_odom_vehicle;
    all.cloud = frame.cloud;
    uncleaned_->keyframes.add(keyframeOf(all));
    uncleaned_->map.insert(all);
  }
}

void MapBuilder::finish()
{
  if (hindsight_)
  {
    hindsight_->finish([this](const Frame& f) { insert(f); });
  }
}

MapPictureContent MapBuilder::picture() const
{
  MapPictureContent content;
  for (const RunScans& run : runs_)
  {
    if (!content.path.empty())
    {
      content.path.emplace_back(Eigen::Vector3d::Constant(NAN));  // not joined to the run before
    }
    for (const auto& [stamp, pose] : run.trajectory())
    {
      content.path.emplace_back(pose.translation());
    }
    for (const auto& [id, object] : run.movingObjects())
    {
      content.objects.push_back({object.last.object_class, object.path, object.last.box});
    }
  }
  return content;
}

SceneContent MapBuilder::scene() const
{
  SceneContent scene;
  const MapPoints points = map_.points();
  scene.points = points.points;
  scene.intensity = points.intensity;
  for (const RunScans& run : runs_)
  {
    const bool first = scene.trajectory.empty();
    (first ? scene.trajectory : scene.other_trajectories.emplace_back()) = run.trajectory();
    for (const auto& [id, object] : run.movingObjects())
    {
      const int free_id = scene.object_paths.empty() ? id : scene.object_paths.rbegin()->first + 1;
      scene.object_paths[first ? id : free_id] = object.path;
      scene.boxes.push_back(object.last);
      scene.boxes.back().id = first ? id : free_id;
    }
  }
  return scene;
}
}  // namespace dyslam
