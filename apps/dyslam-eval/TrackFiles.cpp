// SPDX-License-Identifier: BSD-3-Clause
#include "TrackFiles.h"

#include <dyslam/core/Error.h>
#include <dyslam/io/GroundTruth.h>
#include <dyslam/io/TrajectoryFiles.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** Speeds by central differences of the centres, one-sided at the ends of a track. */
TrackSpeeds speedsFrom(const std::vector<LabelledBox>& boxes, const Trajectory& poses)
{
  std::map<std::pair<int, int>, Eigen::Vector3d> position;  // id, frame
  for (const LabelledBox& box : boxes)
  {
    if (box.id >= 0 && box.frame >= 0 && static_cast<std::size_t>(box.frame) < poses.size())
    {
      position[{box.id, box.frame}] =
          poses[static_cast<std::size_t>(box.frame)].pose * box.box.center;
    }
  }
  TrackSpeeds speeds;
  for (auto now = position.begin(); now != position.end(); ++now)
  {
    const auto [id, frame] = now->first;
    auto first = position.find({id, frame - 1});
    auto last = position.find({id, frame + 1});
    first = first == position.end() ? now : first;
    last = last == position.end() ? now : last;
    const double dt = poses[static_cast<std::size_t>(last->first.second)].stamp -
                      poses[static_cast<std::size_t>(first->first.second)].stamp;
    if (dt > 0)
    {
      speeds[{frame, id}] = (last->second - first->second).head<2>().norm() / dt;
    }
  }
  return speeds;
}

/** Points per frame and instance. */
std::map<std::pair<int, int>, int> pointCounts(const std::string& labels_folder)
{
  std::map<std::pair<int, int>, int> counts;
  for (const auto& entry : fs::directory_iterator(labels_folder))
  {
    const std::string stem = entry.path().stem().string();
    int frame = 0;
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), frame);
    if (entry.path().extension() != ".label" || error != std::errc() ||
        end != stem.data() + stem.size())
    {
      continue;
    }
    for (const Label label : readLabels(entry.path().string()))
    {
      if (instanceOf(label) != 0)
      {
        ++counts[{frame, instanceOf(label)}];
      }
    }
  }
  return counts;
}

bool leftOut(const LabelledBox& box, const TrackSelection& selection)
{
  const double azimuth = std::atan2(box.box.center.y(), box.box.center.x());
  return box.frame < selection.first_frame || std::abs(azimuth) > 0.5 * selection.view * M_PI / 180;
}

void leaveOut(std::vector<LabelledBox>& boxes, const TrackSelection& selection)
{
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(),
                             [&](const LabelledBox& box) { return leftOut(box, selection); }),
              boxes.end());
}
}  // namespace

TrackData readTruth(const std::string& folder, const TrackSelection& selection)
{
  TrackData data;
  data.boxes = readTracks((fs::path(folder) / "tracks.txt").string());
  const fs::path poses = fs::path(folder) / "poses_tum.txt";
  const fs::path labels = fs::path(folder) / "labels";
  if (fs::exists(poses))
  {
    data.speeds = speedsFrom(data.boxes, readTum(poses.string()));
  }
  const bool has_labels = fs::is_directory(labels);
  const auto counts = has_labels ? pointCounts(labels.string()) : decltype(pointCounts("")){};
  for (LabelledBox& box : data.boxes)
  {
    const auto points = counts.find({box.frame, box.id + selection.instance_offset});
    const bool unseen = has_labels && selection.min_points > 0 &&
                        (points == counts.end() || points->second < selection.min_points);
    const auto speed = data.speeds.find({box.frame, box.id});
    const bool stands = !data.speeds.empty() && selection.min_speed > 0 &&
                        (speed == data.speeds.end() || speed->second < selection.min_speed);
    if (unseen || stands || box.box.center.head<2>().norm() > selection.max_range)
    {
      box.occluded = passed_over_box;
    }
  }
  leaveOut(data.boxes, selection);
  return data;
}

TrackData readRun(const std::string& folder, const TrackSelection& selection)
{
  TrackData data;
  data.boxes = readTracks((fs::path(folder) / "tracks.txt").string());
  leaveOut(data.boxes, selection);
  data.boxes.erase(std::remove_if(data.boxes.begin(), data.boxes.end(),
                                  [&](const LabelledBox& box) {
                                    return box.box.center.head<2>().norm() > selection.max_range;
                                  }),
                   data.boxes.end());
  const std::string path = (fs::path(folder) / "tracks.csv").string();
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  for (int number = 2; std::getline(file, line); ++number)
  {
    std::vector<std::string> fields;
    std::istringstream words(line);
    for (std::string field; std::getline(words, field, ',');)
    {
      fields.push_back(field);
    }
    try
    {
      data.speeds[{std::stoi(fields.at(0)), std::stoi(fields.at(2))}] = std::stod(fields.at(14));
    }
    catch (const std::exception&)
    {
      throw UserError(path + ":" + std::to_string(number) +
                      ": not a line of tracks; write the run again");
    }
  }
  return data;
}

void mergeTypes(std::vector<LabelledBox>& boxes)
{
  for (LabelledBox& box : boxes)
  {
    switch (objectClassFromString(box.type))
    {
      case ObjectClass::car:
      case ObjectClass::van:
      case ObjectClass::truck:
      case ObjectClass::bus:
        box.type = "Vehicle";
        break;
      case ObjectClass::motorcyclist:
        box.type = "Cyclist";
        break;
      default:
        break;
    }
  }
}
}  // namespace dyslam
