// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/Recordings.h>
#include <dyslam/train/ScanFiles.h>

#include <filesystem>
#include <limits>
#include <stdexcept>

namespace dyslam
{
namespace
{
std::vector<PointLabel> pointLabels(const std::string& path, std::size_t points)
{
  std::vector<PointLabel> labels(points, PointLabel::unknown);
  const std::vector<Label> given = readLabels(path, points);
  for (std::size_t i = 0; i < points; ++i)
  {
    if (isMovingLabel(given[i]))
    {
      labels[i] = PointLabel::moving;
    }
    else if (!isIgnoredLabel(given[i]))
    {
      labels[i] = PointLabel::still;
    }
  }
  return labels;
}

std::vector<Eigen::Vector3f> deskewed(const std::vector<Eigen::Vector3f>& points,
                                      const Pose& motion)
{
  const SweepModel sweep;
  const SweepMotion correct(motion, 0.5);
  std::vector<Eigen::Vector3f> result = points;
  for (Eigen::Vector3f& p : result)
  {
    if (isReturn(p))
    {
      p = correct.toReference(p, sweepFraction(p, sweep));
    }
  }
  return result;
}
}  // namespace

Recording loadRecording(const RecordingDescription& description, bool by_own_motion)
{
  const std::vector<std::string> files = listBinFiles(description.folder);
  const std::vector<Pose> poses = readKittiPoses(description.pose_file);
  if (description.last >= files.size() || description.last >= poses.size())
  {
    throw UserError(description.folder + ": frames " + std::to_string(description.first) + " to " +
                    std::to_string(description.last) + " are requested, but there are " +
                    std::to_string(files.size()) + " scans, and " + std::to_string(poses.size()) +
                    " poses in " + description.pose_file + "; frames count from 0");
  }
  if (description.first >= description.last)
  {
    throw UserError(description.folder + ": frames " + std::to_string(description.first) + " to " +
                    std::to_string(description.last) +
                    " are requested; a recording needs two scans or more");
  }
  Recording recording;
  recording.name = std::filesystem::path(description.folder).parent_path().filename().string();
  const auto motionInto = [&](std::size_t k) {
    return k == 0 ? Pose(poses[0].inverse() * poses[1]) : Pose(poses[k - 1].inverse() * poses[k]);
  };
  for (std::size_t k = description.first; k <= description.last; ++k)
  {
    std::vector<Eigen::Vector3f> points =
        readTrainingPoints(files[k], std::numeric_limits<float>::quiet_NaN());
    if (!description.label_folder.empty())
    {
      const std::string stem = std::filesystem::path(files[k]).stem().string();
      recording.labels.push_back(
          pointLabels(description.label_folder + "/" + stem + ".label", points.size()));
    }
    if (description.deskew && poses.size() > 1)
    {
      points = deskewed(points, motionInto(by_own_motion || k == 0 ? k : k - 1));
    }
    recording.scans.push_back(std::move(points));
    recording.T_world_scan.push_back(poses[k]);
  }
  return recording;
}

RecordingDescription parseRecording(const std::string& text,
                                    const std::string& base,
                                    const std::string& field)
{
  const std::string subject = field + ": '" + text + "'";
  const std::vector<std::string> parts = splitFields(text, ';');
  if (parts.size() < 4)
  {
    throw UserError(subject + ": write folder;pose file;first;last[;deskew][;labels=folder]");
  }
  const auto path = [&](const std::string& name)
  { return (std::filesystem::path(base) / name).string(); };
  RecordingDescription description;
  description.folder = path(parts[0]);
  description.pose_file = path(parts[1]);
  try
  {
    const int first = wholeNumberOf(parts[2]);
    const int last = wholeNumberOf(parts[3]);
    if (first < 0 || last < 0)
    {
      throw std::out_of_range("below 0");
    }
    description.first = static_cast<std::size_t>(first);
    description.last = static_cast<std::size_t>(last);
  }
  catch (const std::logic_error&)
  {
    throw UserError(subject + ": first and last must be frame numbers");
  }
  for (std::size_t i = 4; i < parts.size(); ++i)
  {
    if (parts[i] == "deskew")
    {
      description.deskew = true;
    }
    else if (parts[i].rfind("labels=", 0) == 0)
    {
      description.label_folder = path(parts[i].substr(7));
    }
    else
    {
      throw UserError(subject + ": '" + parts[i] + "' is neither deskew nor labels=");
    }
  }
  return description;
}
}  // namespace dyslam
