// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanPoses.h>

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace dyslam
{
/** Data of a recording in addition to its scans. */
struct RunScansOptions
{
  PreprocessOptions preprocess;
  std::string labels;  //!< folder of NNNNNN.label files, or folder with a subfolder `labels`
  /** Boxes of objects, of which moving ones are left out of the map: tracks.txt, or tracks.csv of a
   * run with its tracks.txt beside it. */
  std::string tracks;
  std::string scan_table;  //!< scans.csv of the run: scans that were not registered are left out
  /** Largest difference of time stamps if the pose cannot be interpolated [s]. */
  double tolerance = 0.01;
  std::string name;  //!< name of the run in pictures; may be empty
};

/** A moving object: its path and last box. */
struct ObjectPath
{
  std::vector<Eigen::Vector3d> path;  //!< path of the box's centre, map frame [m]
  LabelledBox last;                   //!< last box, map frame
};

/** Clouds and moving points of the scans of a recording along its trajectory. */
class RunScans
{
 public:
  /** Reads labels' folder and tracks. \param pool outlives this \throws UserError. */
  RunScans(const Trajectory& trajectory, const RunScansOptions& options, ThreadPool& pool);

  [[nodiscard]] const Trajectory& trajectory() const { return poses_.trajectory(); }
  /** T_map_vehicle at the time of a scan, see ScanPoses. */
  [[nodiscard]] std::optional<Pose> poseOf(const Frame& frame) const;
  /** False if the run could not register the scan, so that its pose is a prediction. */
  [[nodiscard]] bool isRegistered(const Frame& frame) const
  {
    return unregistered_.count(frame.index) == 0;
  }
  [[nodiscard]] bool hasLabels() const { return !label_folder_.empty(); }

  /** Number of scans that the tracks' boxes need: the index of the last one with a box, plus 1. */
  [[nodiscard]] std::size_t trackedScans() const
  {
    return boxes_.empty() ? 0 : static_cast<std::size_t>(boxes_.rbegin()->first) + 1;
  }

  /** First pass over all scans, before fillMoving(), if there are tracks: collects the objects of a
   * scan. An object that ever moves counts as moving in all scans: if it is dynamic in any scan of
   * the tracks.csv beside tracks.txt or, if the table lacks it or there is no table, if its box
   * moves by more than 1 m. */
  void noteObjects(const Frame& frame);
  /** Cloud of a scan, deskewed with the motion along the trajectory. */
  void fillCloud(Frame& frame) const;
  /** Sets `moving` by labels, and `objects`. \pre cloud and T_odom_vehicle are set, `moving` and
   * `objects` are empty */
  void fillMoving(Frame& frame) const;
  /** Labels of a frame, one per point of the cloud. \pre hasLabels() \throws UserError. */
  [[nodiscard]] std::vector<Label> labelsOf(const Frame& frame) const;

  /** Moving objects by track id. \pre noteObjects() of every scan */
  [[nodiscard]] std::map<int, ObjectPath> movingObjects() const;
  /** RunScansOptions::name. */
  [[nodiscard]] const std::string& name() const { return options_.name; }

 private:
  ScanPoses poses_;
  RunScansOptions options_;
  std::string label_folder_;
  Preprocessor preprocessor_;
  std::multimap<int, LabelledBox> boxes_;  // by frame, lidar frame
  std::map<int, ObjectPath> objects_;
  std::map<int, bool> moves_;
  std::map<int, bool> dynamic_;         // by id: dynamic by the table of the tracks
  std::set<std::size_t> unregistered_;  // Frame::index
};
}  // namespace dyslam
