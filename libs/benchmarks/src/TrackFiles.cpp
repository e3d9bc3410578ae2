// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Options.h>
#include <dyslam/benchmarks/TrackFiles.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>
#include <dyslam/formats/ScanTable.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrackTable.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr double all_around = 360;   // [deg]
constexpr double kitti_camera = 81;  // field of view of KITTI's colour cameras [deg]

/** T_world_lidar by frame index, for scans with a true pose. The indices and stamps of the scans
 * and the sensor pose are read from the rawlog, `x.rawlog` next to `x.gt`. */
std::map<int, StampedPose> lidarPoses(const std::string& folder,
                                      const Trajectory& T_world_vehicle,
                                      const NoteSink& note)
{
  constexpr double tolerance = 1e-3;  // [s]; small, since both files contain the scans' stamps
  fs::path rawlog = fs::absolute(folder).lexically_normal();
  rawlog = (rawlog.has_filename() ? rawlog : rawlog.parent_path()).replace_extension(".rawlog");
  if (!fs::exists(rawlog))
  {
    throw UserError(rawlog.string() + ": no such file; true speeds require it next to " + folder +
                    "; put it there, or give its tracks.txt, of which all boxes count");
  }
  RawlogSource source(rawlog.string());
  std::map<int, StampedPose> poses;
  try
  {
    while (const auto frame = source.next())
    {
      if (const auto pose = T_world_vehicle.nearest(frame->scan.stamp, tolerance))
      {
        poses[static_cast<int>(frame->index)] = {
            frame->scan.stamp, T_world_vehicle[*pose].pose * frame->scan.T_vehicle_lidar};
      }
    }
  }
  catch (const UserError& error)
  {
    note(std::string(error.what()) + "; true speeds after it are unknown");
  }
  return poses;
}

/** Number of points by (frame, instance). */
using PointCounts = std::map<std::pair<int, int>, int>;

PointCounts pointCounts(const std::string& labels_folder)
{
  PointCounts counts;
  for (const auto& entry : entriesOf(labels_folder))
  {
    const auto frame = numberOfName(entry.path().filename().string(), ".label");
    if (!frame)
    {
      continue;
    }
    for (const Label label : readLabels(entry.path().string()))
    {
      if (instanceOf(label) != 0)
      {
        ++counts[{*frame, instanceOf(label)}];
      }
    }
  }
  return counts;
}

/** Whether the boxes were labelled in camera images, which show nothing beside and behind. */
bool fromImages(const std::vector<LabelledBox>& boxes)
{
  return std::any_of(boxes.begin(), boxes.end(),
                     [](const LabelledBox& box) { return !box.image_box.isZero(); });
}

/** Instance minus track id: 0, or 1 where id 0 is in use. */
int instanceOffset(const std::vector<LabelledBox>& boxes, const PointCounts& counts)
{
  const auto boxes_with_points = [&](int offset)
  {
    return std::count_if(boxes.begin(), boxes.end(),
                         [&](const LabelledBox& box) {
                           return counts.count({box.frame, box.id + offset}) != 0;
                         });
  };
  return boxes_with_points(1) > boxes_with_points(0) ? 1 : 0;
}

/** Speeds in a run's tracks.csv, by frame and id, without empty fields. */
TrackSpeeds readTrackSpeeds(const std::string& path)
{
  const TrackTable tracks =
      readTrackTable(path, {TrackValue::frame, TrackValue::id, TrackValue::speed});
  if (!tracks.missing.empty())
  {
    throw UserError(path + ": has no column " + tracks.missing + "; repeat the run");
  }
  TrackSpeeds speeds;
  for (const TrackTableRow& row : tracks.rows)
  {
    if (row.speed)
    {
      speeds[{row.frame, row.id}] = *row.speed;
    }
  }
  return speeds;
}

/** Whether a box is beyond view or range. */
bool isOutside(const LabelledBox& box, const TrackSelection& selection)
{
  const double azimuth = std::atan2(box.box.centre.y(), box.box.centre.x());
  return std::abs(azimuth) > 0.5 * selection.view.value_or(all_around) * M_PI / 180 ||
         box.box.centre.head<2>().norm() > selection.max_range;
}

/** Whether a box is within 2 m of one of the centres of its frame. */
bool isNear(const LabelledBox& box, const CentresByFrame& centres)
{
  constexpr double margin = 2;  // [m]
  const auto of_frame = centres.find(box.frame);
  return of_frame != centres.end() &&
         std::any_of(of_frame->second.begin(), of_frame->second.end(),
                     [&](const Eigen::Vector3d& centre)
                     { return (box.box.centre - centre).head<2>().norm() <= margin; });
}

template <typename Condition>
void removeIf(std::vector<LabelledBox>& boxes, Condition condition)
{
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(), condition), boxes.end());
}

/** Indices of the first and last scan in the scans.csv of a run; nothing without a scan or the
 * file. \throws UserError for a damaged file. */
std::optional<FrameRange> framesOfTable(const std::string& folder)
{
  const fs::path path = fs::path(folder) / run_files::scan_table;
  if (!fs::exists(path) || fs::is_empty(path))
  {
    return std::nullopt;
  }
  const std::vector<std::size_t> scans = scansOfTable(path.string());
  if (scans.empty())
  {
    return std::nullopt;
  }
  return FrameRange{static_cast<int>(scans.front()), static_cast<int>(scans.back())};
}

/** The same of report and ini: of a run in which no scan was dropped for its time stamp. */
std::optional<FrameRange> framesOfReport(const std::string& folder)
{
  const fs::path ini = fs::path(folder) / run_files::settings;
  const auto report = readRunReport(folder);
  if (!report || !fs::exists(ini))
  {
    return std::nullopt;
  }
  const Config config = Config::fromFile(ini.string());
  if (!report->frames || !config.has("input", "skip_first_n"))
  {
    return std::nullopt;
  }
  RawlogSourceOptions input;
  load(input, config, "input");
  if (input.start > 0)
  {
    return std::nullopt;  // the number of the first scan is not known
  }
  return FrameRange{input.skip_first_n, input.skip_first_n + static_cast<int>(*report->frames) - 1};
}
}  // namespace

TrackData readTruth(const std::string& folder, TrackSelection& selection, const NoteSink& note)
{
  TrackData data;
  data.boxes = readTracks((fs::path(folder) / "tracks.txt").string());
  const fs::path poses = fs::path(folder) / true_poses_file;
  const fs::path labels = fs::path(folder) / "labels";
  if (fs::exists(poses))
  {
    const auto T_world_lidar = lidarPoses(folder, readTum(poses.string()), note);
    data.speeds = speedsFrom(data.boxes, T_world_lidar);
    data.hidden = hiddenCentres(data.boxes, T_world_lidar);
    if (T_world_lidar.empty())
    {
      note(poses.string() +
           " has no pose within 1 ms of a scan of the rawlog: speeds and hidden objects are not "
           "known, so boxes at rest count, too");
    }
  }
  else if (selection.min_speed > 0)
  {
    note(folder + " has no poses_tum.txt: speeds are not known, so boxes at rest count, too");
  }
  const bool has_labels = fs::is_directory(labels);
  if (!has_labels && selection.min_points > 0)
  {
    note(folder + " has no labels: boxes count whatever the number of their points");
  }
  const PointCounts counts = has_labels ? pointCounts(labels.string()) : PointCounts();
  selection.view = selection.view.value_or(fromImages(data.boxes) ? kitti_camera : all_around);
  selection.instance_offset =
      selection.instance_offset.value_or(instanceOffset(data.boxes, counts));
  for (LabelledBox& box : data.boxes)
  {
    const auto points = counts.find({box.frame, box.id + *selection.instance_offset});
    const bool few_points = has_labels && selection.min_points > 0 &&
                            (points == counts.end() || points->second < selection.min_points);
    const auto speed = data.speeds.find({box.frame, box.id});
    const bool slow = !data.speeds.empty() && selection.min_speed > 0 &&
                      (speed == data.speeds.end() || speed->second < selection.min_speed);
    if (few_points || slow || isOutside(box, selection))
    {
      box.occluded = ignored_box;
    }
  }
  removeIf(data.boxes, [&](const LabelledBox& box) { return box.frame < selection.first_frame; });
  return data;
}

TrackData readRun(const std::string& folder)
{
  TrackData data;
  data.boxes = readTracks((fs::path(folder) / run_files::tracks).string());
  const std::string path = (fs::path(folder) / run_files::track_table).string();
  if (fs::exists(path))
  {
    data.speeds = readTrackSpeeds(path);
  }
  return data;
}

void removeUncovered(std::vector<LabelledBox>& estimates,
                     const TrackData& truth,
                     const TrackSelection& selection)
{
  CentresByFrame counted;
  for (const LabelledBox& box : truth.boxes)
  {
    if (box.id >= 0 && box.occluded != ignored_box)
    {
      counted[box.frame].push_back(box.box.centre);
    }
  }
  removeIf(
      estimates,
      [&](const LabelledBox& box)
      {
        return box.frame < selection.first_frame ||
               ((isOutside(box, selection) || isNear(box, truth.hidden)) && !isNear(box, counted));
      });
}

std::optional<FrameRange> processedFrames(const std::string& folder)
{
  const auto range = framesOfTable(folder);
  return range ? range : framesOfReport(folder);
}

std::string mergedType(const std::string& type)
{
  switch (objectClassFromString(type))
  {
    case ObjectClass::car:
    case ObjectClass::van:
    case ObjectClass::truck:
    case ObjectClass::bus:
      return "Vehicle";
    case ObjectClass::motorcyclist:
      return toString(ObjectClass::cyclist);
    default:
      return type;
  }
}

void mergeTypes(std::vector<LabelledBox>& boxes)
{
  for (LabelledBox& box : boxes)
  {
    box.type = mergedType(box.type);
  }
}
}  // namespace dyslam
