// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/Recordings.h>
#include <dyslam/train/ScanFiles.h>

#include <filesystem>
#include <limits>

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

/** Requires that pose k is that of scan k of the folder, up to the last scan requested: there are
 * as many poses as scans, or no number is missing among the names. \throws UserError. */
void requirePosesOfScans(const std::vector<std::string>& files,
                         std::size_t poses,
                         const RecordingDescription& description)
{
  const auto first = frameNumberOf(files.front());
  for (std::size_t k = 0; k <= description.last && files.size() != poses && first; ++k)
  {
    const std::int64_t expected = *first + static_cast<std::int64_t>(k);
    if (frameNumberOf(files[k]) != expected)
    {
      throw UserError(description.folder + ": has no scan with number " + std::to_string(expected) +
                      ", and " + description.pose_file + " has " + counted(poses, "pose") +
                      " for " + counted(files.size(), "scan") +
                      ": from there on they may be of other scans; leave out those without a scan, "
                      "or request frames before");
    }
  }
}
}  // namespace

Recording loadRecording(const RecordingDescription& description, bool by_own_motion)
{
  const std::vector<std::string> files = listBinFiles(description.folder);
  const std::vector<Pose> poses = readLidarPoses(description);
  if (description.last >= files.size() || description.last >= poses.size())
  {
    throw UserError(description.folder + ": frames " + std::to_string(description.first) + " to " +
                    std::to_string(description.last) + " are requested, but there are " +
                    counted(files.size(), "scan") + ", and " + counted(poses.size(), "pose") +
                    " in " + description.pose_file + "; frames count from 0");
  }
  if (description.first >= description.last)
  {
    throw UserError(description.folder + ": frames " + std::to_string(description.first) + " to " +
                    std::to_string(description.last) +
                    " are requested; a recording needs two scans or more");
  }
  requirePosesOfScans(files, poses.size(), description);
  Recording recording;
  // The folder above that of the scans; a slash at the end does not count.
  recording.name = std::filesystem::absolute(description.folder + "/")
                       .lexically_normal()
                       .parent_path()
                       .parent_path()
                       .filename()
                       .string();
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
    if (description.deskew)
    {
      points = deskewByAzimuth(std::move(points),
                               motionInto(poses, by_own_motion || k == 0 ? k : k - 1));
    }
    recording.scans.push_back(std::move(points));
    recording.T_world_scan.push_back(poses[k]);
  }
  return recording;
}
}  // namespace dyslam
