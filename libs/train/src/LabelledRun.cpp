// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/LabelledRun.h>
#include <dyslam/train/ScanFiles.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <system_error>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Requires a label for each point, by the sizes of the files, so that a training does not fail
 * hours later. \throws UserError. */
void requireLabels(const std::string& points_file, const std::string& label_file)
{
  constexpr std::uintmax_t bytes_per_point = 4 * sizeof(float);
  std::error_code missing;
  const std::uintmax_t label_bytes = fs::file_size(label_file, missing);
  if (missing)
  {
    throw UserError(label_file +
                    ": cannot be read, but the frame is requested; every scan needs a "
                    "file of labels");
  }
  const std::uintmax_t points = fs::file_size(points_file) / bytes_per_point;
  if (label_bytes != points * sizeof(Label))
  {
    throw UserError(label_file + ": has " + std::to_string(label_bytes / sizeof(Label)) +
                    " labels, but " + points_file + " has " + std::to_string(points) +
                    " points; they must be of the same scan");
  }
}

/** The scans of a folder by frame number. \throws UserError for two of the same number. */
std::map<std::size_t, std::string> scansByNumber(const std::string& folder)
{
  std::map<std::size_t, std::string> files;
  for (const std::string& file : listBinFiles(folder))
  {
    const auto number = frameNumberOf(file);
    if (number && !files.try_emplace(static_cast<std::size_t>(*number), file).second)
    {
      throw UserError(file + ": has the same frame number as " +
                      files[static_cast<std::size_t>(*number)] + "; remove one");
    }
  }
  return files;
}

/** The point nearest to the mean of some points: on an object, also if it is several. */
Eigen::Vector3f centralPoint(const std::vector<Eigen::Vector3f>& points,
                             const std::vector<std::size_t>& which)
{
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : which)
  {
    mean += points[i].cast<double>() / static_cast<double>(which.size());
  }
  Eigen::Vector3f nearest = Eigen::Vector3f::Zero();
  double distance = std::numeric_limits<double>::infinity();
  for (const std::size_t i : which)
  {
    const double d = (points[i].cast<double>() - mean).squaredNorm();
    if (d < distance)
    {
      distance = d;
      nearest = points[i];
    }
  }
  return nearest;
}
}  // namespace

LabelledRun::LabelledRun(const RecordingDescription& description, double period)
    : period_(period), deskew_(description.deskew)
{
  const std::string range =
      std::to_string(description.first) + " to " + std::to_string(description.last);
  if (description.first >= description.last)
  {
    throw UserError(description.folder + ": frames " + range +
                    " are requested; a recording needs two scans or more");
  }
  const auto files = scansByNumber(description.folder);
  const std::vector<Pose> poses = readLidarPoses(description);
  if (description.last >= poses.size())
  {
    throw UserError(description.pose_file + ": has " + std::to_string(poses.size()) +
                    " poses, but frame " + std::to_string(description.last) +
                    " is requested (frames count from 0); request fewer frames");
  }
  const std::string label_folder =
      description.label_folder.empty()
          ? (fs::path(description.folder + "/").lexically_normal().parent_path().parent_path() /
             "labels")
                .string()
          : description.label_folder;
  for (std::size_t f = description.first; f <= description.last; ++f)
  {
    const auto file = files.find(f);
    if (file == files.end())
    {
      throw UserError(description.folder + ": has no scan with number " + std::to_string(f) +
                      ", but frames " + range + " are requested; request those that there are");
    }
    Scan scan;
    scan.points_file = file->second;
    scan.label_file = (fs::path(label_folder) / fs::path(file->second).stem()).string() + ".label";
    scan.T_world_sensor = poses[f];
    scan.motion = motionInto(poses, f);
    requireLabels(scan.points_file, scan.label_file);
    scans_.push_back(std::move(scan));
  }
}

std::vector<Eigen::Vector3f> LabelledRun::points(std::size_t frame) const
{
  const Scan& scan = scans_.at(frame);
  std::vector<Eigen::Vector3f> points = readTrainingPoints(scan.points_file, 0);
  return deskew_ ? deskewByAzimuth(std::move(points), scan.motion) : points;
}

DysegClip::Frame LabelledRun::frame(std::size_t frame, std::int32_t first_id) const
{
  DysegClip::Frame result;
  result.T_world_sensor = scans_.at(frame).T_world_sensor;
  result.points = points(frame);
  const std::vector<Label> labels = readLabels(scans_[frame].label_file, result.points.size());
  result.object.assign(labels.size(), DysegClip::still);
  std::map<Label, std::vector<std::size_t>> moving;  // points by class and instance
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    if (isIgnoredLabel(labels[i]))
    {
      result.object[i] = DysegClip::unknown;
    }
    else if (isMovingLabel(labels[i]))
    {
      moving[labels[i]].push_back(i);
    }
  }
  std::int32_t id = first_id;
  for (const auto& [label, which] : moving)
  {
    for (const std::size_t i : which)
    {
      result.object[i] = id;
    }
    DysegClip::Object& object = result.objects[id++];
    object.T_sensor_object.translation() = centralPoint(result.points, which).cast<double>();
    object.moving = true;
  }
  return result;
}

DysegSample LabelledRun::sample(std::size_t current, std::size_t past) const
{
  DysegClip::Frame then;  // without objects: where those of the current frame were is not known
  then.T_world_sensor = scans_.at(past).T_world_sensor;
  then.points = points(past);
  const double frames = std::abs(static_cast<double>(current) - static_cast<double>(past));
  return makeSample(frame(current), then, period_ * frames);
}

DysegClip loadLabelledRun(const std::string& folder,
                          const std::string& pose_file,
                          std::size_t first,
                          std::size_t last)
{
  RecordingDescription description;
  description.folder = folder + "/velodyne";
  description.pose_file = pose_file;
  description.first = first;
  description.last = last;
  const LabelledRun run(description, hdl64e_period);
  DysegClip clip;
  clip.name = folder;
  clip.period = hdl64e_period;
  std::int32_t next_id = 1;
  for (std::size_t f = 0; f < run.size(); ++f)
  {
    clip.frames.push_back(run.frame(f, next_id));
    next_id += static_cast<std::int32_t>(clip.frames.back().objects.size());
  }
  return clip;
}
}  // namespace dyslam
