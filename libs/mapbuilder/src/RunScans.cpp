// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/Labels.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanTable.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/mapbuilder/RunScans.h>

#include <algorithm>
#include <filesystem>

#include "TrackFlags.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr double min_distance = 1.0;  // from its start, beyond which an object moves [m]

/** \return empty for no folder \throws UserError for one without labels */
std::string givenLabels(const std::string& folder)
{
  if (folder.empty())
  {
    return folder;
  }
  const auto labels = labelFolderOf(folder);
  if (!labels)
  {
    throw UserError(folder + ": is not a folder of .label files (--labels)");
  }
  return *labels;
}
}  // namespace

RunScans::RunScans(const Trajectory& trajectory, const RunScansOptions& options, ThreadPool& pool)
    : poses_(trajectory, options.tolerance),
      options_(options),
      label_folder_(givenLabels(options.labels)),
      preprocessor_(options.preprocess, pool)
{
  if (trajectory.empty())
  {
    throw UserError("the trajectory has no poses");
  }
  if (!options_.scan_table.empty())
  {
    unregistered_ = unregisteredScans(options_.scan_table);
  }
  if (options_.tracks.empty())
  {
    return;
  }
  const TrackFiles files(options_.tracks);
  if (!files.table.empty())
  {
    dynamic_ = dynamicTracks(files.table, files.table == options_.tracks);
  }
  for (const auto& box : readTracks(files.boxes))
  {
    boxes_.emplace(box.frame, box);
    const auto known = dynamic_.find(box.id);
    moves_[box.id] = known != dynamic_.end() && known->second;
  }
}

std::optional<Pose> RunScans::poseOf(const Frame& frame) const
{
  return poses_.at(frame.scan.stamp);
}

void RunScans::fillCloud(Frame& frame) const
{
  const double sweep = frame.sweep_duration;
  const TimedMotion motion =
      poses_.motionDuring(frame.scan.stamp, preprocessor_.sweepSpan(frame.scan, sweep));
  // The trajectory may be that of every tenth scan: its steps are no revolutions.
  frame.cloud =
      preprocessor_.prepare(frame.scan, motion.from.inverse() * motion.to, motion.dt, sweep);
}

/** One label per point of the cloud. */
std::vector<Label> RunScans::labelsOf(const Frame& frame) const
{
  const std::string path = numberedPath(label_folder_, frame.index, ".label");
  if (!fs::exists(path))
  {
    throw UserError(path + ": no such file, but scan " + std::to_string(frame.index) +
                    " needs its labels; give --labels of this recording, and only scans that have "
                    "them (--skip-first-n, --only-first-n); those of an unfinished run end early, "
                    "dyslam --resume completes it");
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

void RunScans::fillMoving(Frame& frame) const
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
    object.box = transformedBack(it->second.box,
                                 (frame.T_odom_vehicle * frame.scan.T_vehicle_lidar).inverse());
    object.object_class = it->second.object_class;
    object.dynamic = moves_.at(object.id);
    frame.objects.push_back(object);
  }
}

void RunScans::noteObjects(const Frame& frame)
{
  const auto pose = poseOf(frame);
  if (!pose)
  {
    return;
  }
  const Pose T_map_lidar = *pose * frame.scan.T_vehicle_lidar;
  const auto [begin, end] = boxes_.equal_range(static_cast<int>(frame.index));
  for (auto it = begin; it != end; ++it)
  {
    LabelledBox box = it->second;
    box.box = transformedBack(box.box, T_map_lidar.inverse());
    ObjectPath& object = objects_[box.id];
    object.path.push_back(box.box.centre);
    object.last = box;
    const double moved = (object.path.back() - object.path.front()).norm();
    if (dynamic_.count(box.id) == 0)
    {
      moves_[box.id] = moves_[box.id] || moved > min_distance;
    }
  }
}

std::map<int, ObjectPath> RunScans::movingObjects() const
{
  std::map<int, ObjectPath> result;
  for (const auto& [id, object] : objects_)
  {
    if (moves_.at(id))
    {
      result.emplace(id, object);
    }
  }
  return result;
}
}  // namespace dyslam
