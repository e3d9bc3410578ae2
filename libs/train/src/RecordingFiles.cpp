// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/core/Scan.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/RecordingFiles.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace dyslam
{
namespace
{
/** Parses first and last frame. \throws UserError. */
void parseFrames(const std::string& first,
                 const std::string& last,
                 const std::string& subject,
                 RecordingDescription& description)
{
  try
  {
    const int from = wholeNumberOf(first);
    const int to = wholeNumberOf(last);
    if (from < 0 || to < 0)
    {
      throw std::out_of_range("below 0");
    }
    description.first = static_cast<std::size_t>(from);
    description.last = static_cast<std::size_t>(to);
  }
  catch (const std::logic_error&)
  {
    throw UserError(subject + ": first and last must be frame numbers");
  }
}

/** Share of the path of a sensor that is along one of its axes; 0 for short paths. */
double shareAlong(int axis, const std::vector<Pose>& poses)
{
  constexpr double least_path = 10;  // [m]
  Eigen::Vector3d path = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k < poses.size(); ++k)
  {
    path += (poses[k - 1].inverse() * poses[k]).translation().cwiseAbs();
  }
  return path.sum() < least_path ? 0 : path[axis] / path.sum();
}
}  // namespace

RecordingDescription parseRecording(const std::string& text,
                                    const std::string& base,
                                    const std::string& field)
{
  const std::string subject = field + ": '" + text + "'";
  const std::vector<std::string> parts = splitFields(text, ';');
  if (parts.size() < 4)
  {
    throw UserError(
        subject + ": write folder;pose file;first;last[;deskew][;labels=folder][;calib=calib.txt]");
  }
  const auto path = [&](const std::string& name) { return dataPath(base, name); };
  RecordingDescription description;
  description.folder = path(parts[0]);
  description.pose_file = path(parts[1]);
  parseFrames(parts[2], parts[3], subject, description);
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
    else if (parts[i].rfind("calib=", 0) == 0)
    {
      description.calib_file = path(parts[i].substr(6));
    }
    else
    {
      throw UserError(subject + ": '" + parts[i] + "' is none of deskew, labels= and calib=");
    }
  }
  return description;
}

std::vector<Pose> readLidarPoses(const RecordingDescription& description)
{
  // A vehicle drives along x of its lidar and along z of KITTI's camera.
  constexpr double most = 0.8;  // share of the path along the axis of the other sensor
  const std::vector<Pose> poses = readKittiPoses(description.pose_file);
  if (description.calib_file.empty())
  {
    if (shareAlong(2, poses) > most)
    {
      throw UserError(
          description.pose_file +
          ": the sensor drives along its z axis, so these are poses of KITTI's camera; "
          "add ;calib=calib.txt to the recording (for labelled_validation set labelled_calib), or "
          "convert them to the lidar");
    }
    return poses;
  }
  if (shareAlong(0, poses) > most)
  {
    throw UserError(description.pose_file +
                    ": the sensor drives along its x axis, so these are poses of the lidar "
                    "already; leave out calib= (for labelled_validation: labelled_calib)");
  }
  const KittiCalib calib = readKittiCalib(description.calib_file);
  if (!calib.has_camera)
  {
    throw UserError(description.calib_file +
                    ": has no transform from lidar to camera (Tr), needed for the poses of the "
                    "camera; name KITTI's calib.txt");
  }
  return posesOfMountedSensor(poses, calib.T_cam_velo);
}

std::vector<Eigen::Vector3f> deskewByAzimuth(std::vector<Eigen::Vector3f> points,
                                             const Pose& motion)
{
  const SweepModel sweep;
  const SweepMotion correct(motion, 0.5);
  for (Eigen::Vector3f& p : points)
  {
    if (isReturn(p))
    {
      p = correct.toReference(p, sweepFraction(p, sweep));
    }
  }
  return points;
}

Pose motionInto(const std::vector<Pose>& T_world_lidar, std::size_t k)
{
  const std::size_t later = std::max<std::size_t>(k, 1);
  return later < T_world_lidar.size()
             ? Pose(T_world_lidar[later - 1].inverse() * T_world_lidar[later])
             : Pose::Identity();
}
}  // namespace dyslam
