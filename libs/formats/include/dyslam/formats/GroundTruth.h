// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/PoseOrigin.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Name in the folder of the ground truth: T_world_vehicle of the scans. */
constexpr const char* true_poses_file = "poses_tum.txt";

/** Folder of the ground truth beside a rawlog: `dir/x.rawlog` has `dir/x.gt`. */
[[nodiscard]] std::string groundTruthFolder(const std::string& rawlog_path);

/** Simulation settings of a recording. */
struct SimulatedWorld
{
  std::string world;
  std::string sensor;
  double traffic = 0;
  int seed = 0;
};
/** Simulation settings from simulator.ini of a ground-truth folder; nothing without this file.
 * \throws UserError if it is damaged. */
[[nodiscard]] std::optional<SimulatedWorld> simulatedWorld(const std::string& folder);

/** Origin of the true poses from simulator.ini or poses.ini of a ground-truth folder; unknown
 * without both. \throws UserError if poses.ini is damaged. */
[[nodiscard]] PoseOrigin poseOrigin(const std::string& folder);

/** True labels of a frame's points in the order of the scan, those of a recording of several lidars
 * of the merged scan; nothing if the frame has none or the folder doesn't exist.
 * \param frame Frame::index \throws UserError unless there are `points` labels. */
[[nodiscard]] std::optional<std::vector<Label>> trueLabels(const std::string& folder,
                                                           std::size_t frame,
                                                           std::size_t points);

/** \throws UserError if a subfolder of the sidecar is a link: its files may belong to others. */
void requireNoLinks(const std::string& folder);

/** Removes the sidecar of an earlier recording; other files in its folder stay. To be called before
 * the rawlog is replaced, so that a killed program never leaves one beside the truth of another.
 * \throws UserError if a subfolder is a link. */
void removeGroundTruth(const std::string& folder);

/** Writes the sidecar: per-point files at once, poses and tracks when closed. */
class GroundTruthWriter
{
 public:
  /** Creates the folder and removes files of an earlier run in it. \throws UserError, also if a
   * subfolder is a link. */
  explicit GroundTruthWriter(const std::string& folder);
  ~GroundTruthWriter();
  GroundTruthWriter(const GroundTruthWriter&) = delete;
  GroundTruthWriter& operator=(const GroundTruthWriter&) = delete;

  void addPose(double stamp, const Pose& T_world_vehicle);
  /** Sets the origin of the poses, for poses.ini, which is written if there are any. */
  void setPoseOrigin(const PoseOrigin& origin) { origin_ = origin; }
  /** Adds a true box, lidar frame; box.frame is the number of its scan. */
  void addBox(const LabelledBox& box);
  void addLabels(std::size_t frame, const std::vector<Label>& labels);
  /** Adds the scene flow [m]: position of each point's surface in the lidar frame of the next scan
   * at its stamp minus the present position (including ego-motion); NaN if unknown. */
  void addFlow(std::size_t frame, const std::vector<Eigen::Vector3f>& flow);
  /** Writes the simulation settings: simulator.ini. \throws UserError. */
  void addSimulator(const Options& options);
  /** Writes poses_tum.txt, poses.ini and tracks.txt if there is anything for them. */
  void close();

 private:
  std::string folder_;
  Trajectory poses_;
  PoseOrigin origin_;
  std::vector<LabelledBox> boxes_;
  bool closed_ = false;
};

/** Moves a closed sidecar to its folder, at once unless other files are there. Called when its
 * rawlog has its name, after removeGroundTruth(). \param pending a folder on the same file system.
 * \throws UserError. */
void installGroundTruth(const std::string& pending, const std::string& folder);
}  // namespace dyslam
