// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/LabelFiles.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
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

/** Where the true poses of a recording are from. */
enum class PoseSource
{
  unknown,
  simulated,  //!< exact
  gnss_ins,   //!< satellites and inertial unit: off by centimetres from scan to scan
  given       //!< by the user or a data set, of unknown accuracy
};

struct PoseOrigin
{
  PoseSource source = PoseSource::unknown;
  std::string name;  //!< of their file or topic; empty if unknown

  /** Errors against these poses are those of the estimate alone. */
  [[nodiscard]] bool isExact() const { return source == PoseSource::simulated; }
  /** "GNSS/INS (oxts), not exact" */
  [[nodiscard]] std::string text() const;
};
/** The word of a file or a flag: "gnss_ins". */
[[nodiscard]] std::string toString(PoseSource source);
/** Its reverse; unknown for any other word. */
[[nodiscard]] PoseSource poseSourceFromString(const std::string& word);
/** A field of options. */
void describePoseSource(OptionsVisitor& visitor,
                        const char* key,
                        PoseSource& source,
                        const char* help);
/** By simulator.ini or poses.ini of the ground-truth folder; unknown where neither is there.
 * \throws UserError if poses.ini is damaged. */
[[nodiscard]] PoseOrigin poseOrigin(const std::string& folder);

/** Tracks in a text file: the columns of KITTI's tracking labels, but in the lidar frame.
 *
 * `frame id type truncated occluded alpha left top right bottom height width length x y z yaw
 * [score]`; x y z is the box's centre (half height), yaw the heading about +z from +x. See
 * doc/formats.md. \throws UserError "file:line: what". */
[[nodiscard]] std::vector<LabelledBox> readTracks(const std::string& path);
/** One line of such a file. */
[[nodiscard]] std::string trackLine(const LabelledBox& box);
void writeTracks(const std::string& path, const std::vector<LabelledBox>& boxes);

/** Reads the sidecar of a rawlog; per-point files are read when asked for. Frames are counted as
 * Frame::index. */
class GroundTruthReader
{
 public:
  /** \throws UserError if the folder is missing or a file in it is damaged. */
  explicit GroundTruthReader(const std::string& folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  /** T_world_vehicle; empty if unknown. */
  [[nodiscard]] const Trajectory& poses() const { return poses_; }
  /** Boxes of all frames, lidar frame. */
  [[nodiscard]] const std::vector<LabelledBox>& tracks() const { return tracks_; }
  /** Boxes of one frame, lidar frame. */
  [[nodiscard]] std::vector<LabelledBox> boxes(std::size_t frame) const;

  /** Labels of a frame's points in the scan's order; nothing if that frame has none.
   * \throws UserError if their number is not `points`. */
  [[nodiscard]] std::optional<std::vector<Label>> labels(std::size_t frame,
                                                         std::size_t points) const;
  /** Scene flow: where each point's surface is in the NEXT scan's lidar frame at its stamp, minus
   * where the point is now (ego-motion included), metres; NaN where unknown. */
  [[nodiscard]] std::optional<std::vector<Eigen::Vector3f>> flow(std::size_t frame,
                                                                 std::size_t points) const;

 private:
  std::string folder_;
  Trajectory poses_;
  std::vector<LabelledBox> tracks_;
  std::multimap<int, std::size_t> boxes_of_frame_;
};

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
