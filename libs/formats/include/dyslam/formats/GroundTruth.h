// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Options.h>
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
/** By simulator.ini of its ground truth; nothing if there is no such file. \throws UserError if it
 * is damaged. */
[[nodiscard]] std::optional<SimulatedWorld> simulatedWorld(const std::string& folder);

/** By simulator.ini or poses.ini of the ground-truth folder; unknown where neither is there.
 * \throws UserError if poses.ini is damaged. */
[[nodiscard]] PoseOrigin poseOrigin(const std::string& folder);

/** Labels of a frame's points in the scan's order; nothing if that frame has none, or the folder is
 * not there. \param frame counted as Frame::index \throws UserError if their number is not
 * `points`.
 */
[[nodiscard]] std::optional<std::vector<Label>> trueLabels(const std::string& folder,
                                                           std::size_t frame,
                                                           std::size_t points);

/** \throws UserError if a subfolder of the sidecar is a link: its files may belong to others. */
void requireNoLinks(const std::string& folder);

/** Writes the sidecar: per-point files at once, poses and tracks when closed. */
class GroundTruthWriter
{
 public:
  /** Makes the folder; files of an earlier run in it are removed. \throws UserError, also if a
   * subfolder is a link. */
  explicit GroundTruthWriter(const std::string& folder);
  ~GroundTruthWriter();
  GroundTruthWriter(const GroundTruthWriter&) = delete;
  GroundTruthWriter& operator=(const GroundTruthWriter&) = delete;

  void addPose(double stamp, const Pose& T_world_vehicle);
  /** Where the poses are from: poses.ini, if there are any. */
  void setPoseOrigin(const PoseOrigin& origin) { origin_ = origin; }
  /** Lidar frame; box.frame says which scan. */
  void addBox(const LabelledBox& box);
  void addLabels(std::size_t frame, const std::vector<Label>& labels);
  /** Scene flow: where each point's surface is in the NEXT scan's lidar frame at its stamp, minus
   * where the point is now (ego-motion included), metres; NaN where unknown. */
  void addFlow(std::size_t frame, const std::vector<Eigen::Vector3f>& flow);
  /** What the recording was simulated with: simulator.ini. \throws UserError. */
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
}  // namespace dyslam
