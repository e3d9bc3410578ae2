// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapbuilder/MapBuilder.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double keyframe_angle = 0.17;  // a scan is used after this rotation [rad]

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

MapBuilder::MapBuilder(const MapBuilderOptions& options, const MapProducts& products)
    : options_(options),
      products_(products),
      pool_(options.threads),
      memory_(MemoryLimit(options.memory, products.temporary_folder)
                  .part(products.uncleaned_map ? 0.5 : 1.0)),
      keyframes_(memory_),
      map_(options.map, keyframes_)
{
  if (!products_.scan_store.empty())
  {
    scans_.emplace(products_.scan_store, options_.map);
  }
  if (products_.uncleaned_map)
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

void MapBuilder::add(Frame frame)
{
  RunScans& run = runs_.back();
  recorded_ = recorded_.value_or(frame.scan.stamp);
  const auto pose = run.poseOf(frame);
  if (!pose)
  {
    ++skipped_;
    return;
  }
  if (!run.isRegistered(frame))
  {
    ++unregistered_;
    return;
  }
  frame.T_odom_vehicle = *pose;
  frame.is_keyframe = isKeyframe(frame.T_odom_vehicle);
  if (!frame.is_keyframe && !hindsight_)
  {
    return;
  }
  run.fillCloud(frame);
  if (frame.is_keyframe)
  {
    last_keyframe_ = frame.T_odom_vehicle;
    reach_ = std::max(reach_, frame.T_odom_vehicle.translation().norm());
    run.fillMoving(frame);
    if (products_.labelled_map)
    {
      labelled_.add(frame, run.hasLabels() ? run.labelsOf(frame) : std::vector<Label>());
    }
    keyframes_.add(keyframeOf(frame));
  }
  if (!hindsight_)
  {
    insert(frame);
    return;
  }
  hindsight_->add(frame, frame.is_keyframe ? FrameParts::all : FrameParts::none,
                  [this](const Frame& f) { insert(f); });
}

void MapBuilder::insert(const Frame& frame)
{
  if (!frame.is_keyframe)
  {
    return;
  }
  if (products_.whole_map)
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
}  // namespace dyslam
