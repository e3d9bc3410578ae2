// SPDX-License-Identifier: BSD-3-Clause
#include "MapBuilder.h"

#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Labels.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr double min_distance = 1.0;     // from its start, beyond which an object moves [m]
constexpr double keyframe_angle = 0.17;  // a scan is used after this turn, wherever it is [rad]
constexpr double labelled_voxel = 0.1;   // of the labelled map [m]

std::string labelFolder(const std::string& folder)
{
  if (folder.empty())
  {
    return folder;
  }
  const fs::path inner = fs::path(folder) / "labels";
  const std::string result = fs::is_directory(inner) ? inner.string() : folder;
  const auto isLabelFile = [](const fs::path& path) { return path.extension() == ".label"; };
  if (!fs::is_directory(result) ||
      std::none_of(fs::directory_iterator(result), fs::directory_iterator(), isLabelFile))
  {
    throw UserError(folder + ": is not a folder of .label files (--labels)");
  }
  return result;
}

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

/** Nothing is taken out of it. */
StaticMapOptions uncleaned(StaticMapOptions options)
{
  options.visibility = false;
  options.min_hits = 1;
  return options;
}
}  // namespace

MapBuilder::MapBuilder(const Trajectory& trajectory, const MapBuilderOptions& options)
    : trajectory_(trajectory),
      options_(options),
      label_folder_(labelFolder(options.labels)),
      pool_(options.threads),
      preprocessor_(options.preprocess, pool_),
      map_(options.map, keyframes_)
{
  if (trajectory_.empty())
  {
    throw UserError("the trajectory has no poses");
  }
  origin_ = originOf(trajectory_);
  trajectory_ = relativeTo(origin_, trajectory_);
  if (!options_.scan_store.empty())
  {
    scans_.emplace(options_.scan_store, options_.map);
  }
  if (options_.uncleaned_map)
  {
    uncleaned_ = std::make_unique<Uncleaned>(uncleaned(options_.map));
  }
  if (options_.hindsight.hindsight && label_folder_.empty())
  {
    hindsight_.emplace(options_.hindsight, options_.threads);
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
  return trajectory_.nearest(frame.scan.stamp, options_.tolerance);
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

void MapBuilder::fillCloud(Frame& frame, std::size_t pose) const
{
  const Trajectory& t = trajectory_;
  Pose T_previous_current = Pose::Identity();
  double dt = 0;
  if (t.size() > 1)
  {
    const std::size_t current = std::max<std::size_t>(pose, 1);
    T_previous_current = t[current - 1].pose.inverse() * t[current].pose;
    dt = t[current].stamp - t[current - 1].stamp;
  }
  frame.cloud = preprocessor_.prepare(frame.scan, T_previous_current, dt);
}

/** One label per point of the cloud. */
std::vector<Label> MapBuilder::labelsOf(const Frame& frame) const
{
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.label", frame.index);
  const std::string path = (fs::path(label_folder_) / name).string();
  if (!fs::exists(path))
  {
    throw UserError(path + ": no such file, but scan " + std::to_string(frame.index) +
                    " needs its labels; give --labels of this recording, and the --skip-first-n "
                    "and --only-first-n of the run that wrote them");
  }
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
      frame.moving.push_back(isMovingLabel(label));
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
  const auto pose = poseOf(frame);
  if (!pose)
  {
    return;
  }
  const Pose T_map_lidar = trajectory_[*pose].pose * frame.scan.T_vehicle_lidar;
  const auto [begin, end] = boxes_.equal_range(static_cast<int>(frame.index));
  for (auto it = begin; it != end; ++it)
  {
    LabelledBox box = it->second;
    box.box = transformed(box.box, T_map_lidar);
    auto& path = object_paths_[box.id];
    path.push_back(box.box.center);
    last_boxes_[box.id] = box;
    moves_[box.id] = moves_[box.id] || (path.back() - path.front()).norm() > min_distance;
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
  const auto pose = poseOf(frame);
  if (!pose)
  {
    ++skipped_;
    return;
  }
  frame.T_odom_vehicle = trajectory_[*pose].pose;
  frame.is_keyframe = isKeyframe(frame.T_odom_vehicle);
  if (!frame.is_keyframe && !hindsight_)
  {
    return;
  }
  fillCloud(frame, *pose);
  if (frame.is_keyframe)
  {
    last_keyframe_ = frame.T_odom_vehicle;
    fillMoving(frame);
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
  for (const auto& [stamp, pose] : trajectory_)
  {
    content.path.emplace_back(pose.translation());
  }
  for (const auto& [id, path] : object_paths_)
  {
    if (moves_.at(id))
    {
      const LabelledBox& last = last_boxes_.at(id);
      content.objects.push_back({last.object_class, path, last.box});
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
  scene.trajectory = trajectory_;
  for (const auto& [id, path] : object_paths_)
  {
    if (moves_.at(id))
    {
      scene.object_paths[id] = path;
      scene.boxes.push_back(last_boxes_.at(id));
    }
  }
  return scene;
}
}  // namespace dyslam
