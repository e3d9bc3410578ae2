// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/io/Labels.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/io/ReplayWriter.h>
#include <dyslam/io/SceneExport.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/SlamRun.h>
#include <dyslam/pipeline/WriteBehind.h>

#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Ini section `[output]`: which files a run leaves. */
struct OutputOptions : Options
{
  bool replay = true;
  bool simplemap = true;
  bool pcd = true;
  bool ply = true;
  bool scene = true;
  bool plot = true;
  double scene_voxel_size = 0.4;  //!< of the map points in the scene [m]

  void describe(OptionsVisitor& visitor) override;
};

/** Everything a run writes into its folder.
 *
 * While frames come, the odometry, the tracks, labels and the replay grow on disk; finish() writes
 * what is only known at the end. */
class RunOutputs
{
 public:
  /** Makes the folder and opens the files. \throws UserError if it cannot be written to. */
  RunOutputs(const SlamRunSettings& settings,
             const OutputOptions& options,
             const ReplayWriterOptions& replay,
             const Config& effective);

  /** Takes the frame over; slow writing happens in another thread. */
  void add(Frame frame, const Pipeline& pipeline);

  /** The final files. \throws UserError. */
  void finish(const Pipeline& pipeline);
  /** report.json: the last file, so that a folder that has it is whole. */
  void writeReport(SlamRunReport& report, const std::map<std::string, double>& stage_ms);

  [[nodiscard]] std::size_t trackCount() const { return moving_.size(); }
  [[nodiscard]] bool hasReference() const { return !reference_.empty(); }
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  /** All in the odometry frame. */
  struct MovingObject
  {
    std::vector<std::pair<std::size_t, Eigen::Vector3d>> path;  //!< ordinals of frames, centres
    LabelledBox last;                                           //!< where it was reported last
    Eigen::Vector3d velocity;
  };

  [[nodiscard]] std::string path(const std::string& name);
  void addTracks(const Frame& frame, const Pipeline& pipeline);
  /** What became of a scan: the row of scans.csv. */
  void addScan(const Frame& frame);
  /** SemanticKITTI's label of every point of the frame's scan. */
  [[nodiscard]] static std::vector<Label> labelsOf(const Frame& frame);
  void writeStaticScan(const Frame& frame, const std::vector<Label>& labels);
  void writeTrajectories(const Trajectory& trajectory);
  void writeGraphs(const Pipeline& pipeline);
  void writeMap(const Pipeline& pipeline, const Trajectory& trajectory);
  void addMovingObjects(const Trajectory& trajectory, SceneContent& scene) const;
  void writePlot(const Trajectory& trajectory);

  std::string folder_;
  std::string input_;  //!< of the recording, absolute
  bool labels_;
  bool static_scans_;
  OutputOptions options_;
  std::vector<std::string> files_;
  std::ofstream odometry_;
  std::ofstream tracks_csv_;
  std::ofstream scans_csv_;
  Trajectory reference_;  //!< ground truth in the map frame
  std::vector<LabelledBox> tracks_;
  std::vector<Pose> T_odom_vehicle_;  //!< of every frame
  std::map<int, MovingObject> moving_;
  std::unique_ptr<ReplayWriter> replay_;
  std::unique_ptr<RawlogWriter> static_rawlog_;
  std::unique_ptr<WriteBehind> writer_;  //!< last: its jobs use the members above
};
}  // namespace dyslam
