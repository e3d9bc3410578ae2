// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Deskew.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Labels.h>
#include <dyslam/core/Scan.h>
#include <dyslam/train/Recordings.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace dyslam
{
namespace
{
std::vector<PointLabel> pointLabels(const std::string& path, std::size_t points)
{
  std::vector<PointLabel> labels(points, PointLabel::unknown);
  const std::vector<std::uint32_t> given = readLabels(path, points);
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

std::vector<std::string> split(const std::string& text, char separator)
{
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);)
  {
    const auto begin = part.find_first_not_of(' ');
    const auto end = part.find_last_not_of(' ');
    parts.push_back(begin == std::string::npos ? "" : part.substr(begin, end - begin + 1));
  }
  return parts;
}
}  // namespace

Recording loadRecording(const RecordingDescription& description, bool by_own_motion)
{
  const std::vector<std::string> files = binFiles(description.folder);
  const std::vector<Pose> poses = readPoses12(description.pose_file);
  if (description.last >= files.size() || description.last >= poses.size())
  {
    throw UserError(description.folder + ": frames " + std::to_string(description.first) + " to " +
                    std::to_string(description.last) + " are asked for, but there are " +
                    std::to_string(std::min(files.size(), poses.size())));
  }
  if (description.first >= description.last)
  {
    throw UserError(description.folder + ": frames " + std::to_string(description.first) + " to " +
                    std::to_string(description.last) +
                    " are asked for; a recording needs two scans or more");
  }
  Recording recording;
  recording.name = std::filesystem::path(description.folder).parent_path().filename().string();
  const auto motionInto = [&](std::size_t k) {
    return k == 0 ? Pose(poses[0].inverse() * poses[1]) : Pose(poses[k - 1].inverse() * poses[k]);
  };
  for (std::size_t k = description.first; k <= description.last; ++k)
  {
    std::vector<Eigen::Vector3f> points = readBinPoints(files[k]);
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

RecordingDescription parseRecording(const std::string& text, const std::string& base)
{
  const std::vector<std::string> parts = split(text, ';');
  if (parts.size() < 4)
  {
    throw UserError("recording '" + text +
                    "': write folder;pose file;first;last[;deskew][;labels=folder]");
  }
  const auto path = [&](const std::string& name)
  { return (std::filesystem::path(base) / name).string(); };
  RecordingDescription description;
  description.folder = path(parts[0]);
  description.pose_file = path(parts[1]);
  try
  {
    description.first = std::stoul(parts[2]);
    description.last = std::stoul(parts[3]);
  }
  catch (const std::exception&)
  {
    throw UserError("recording '" + text + "': first and last must be frame numbers");
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
      throw UserError("recording '" + text + "': '" + parts[i] + "' is neither deskew nor labels=");
    }
  }
  return description;
}
}  // namespace dyslam
