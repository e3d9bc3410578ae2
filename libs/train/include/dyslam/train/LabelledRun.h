// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/DysegData.h>
#include <dyslam/train/RecordingFiles.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
constexpr double hdl64e_period = 0.1034;  //!< time between scans of KITTI's HDL-64E [s]

/** Frames of a recording with SemanticKITTI labels per point (0 and 1 ignored, 251 to 259 moving)
 * and a pose per scan.
 *
 * Scans are read when they are needed: a sequence of SemanticKITTI would take 6 GB. Frames are
 * counted by their position in the range of the description, from 0. Several threads may call any
 * method at a time.
 */
class LabelledRun
{
 public:
  /** Reads the poses, a line for each frame number, and checks that every frame has a scan and as
   * many labels as points. \param description first and last are frame numbers, as in the names of
   * the scans; without a folder of labels they are in `labels` beside the folder of the scans
   * \param period time between frames [s] \throws UserError. */
  LabelledRun(const RecordingDescription& description, double period);

  [[nodiscard]] std::size_t size() const { return scans_.size(); }
  /** Points of a frame, as DysegClip::Frame::points. \throws UserError. */
  [[nodiscard]] std::vector<Eigen::Vector3f> points(std::size_t frame) const;
  /** A frame with its moving points by instance. The motions of the instances are not known: the
   * caller gives those of each frame ids of their own. \param first_id id of its first instance
   * \throws UserError. */
  [[nodiscard]] DysegClip::Frame frame(std::size_t frame, std::int32_t first_id = 1) const;
  /** A pair of frames. Moving points have no flow. \throws UserError. */
  [[nodiscard]] DysegSample sample(std::size_t current, std::size_t past) const;

 private:
  struct Scan
  {
    std::string points_file;
    std::string label_file;
    Pose T_world_sensor = Pose::Identity();
    Pose motion = Pose::Identity();  //!< during the sweep
  };

  std::vector<Scan> scans_;
  double period_;
  bool deskew_;
};

/** All frames of a LabelledRun of an HDL-64E in memory, from a folder with `velodyne` and `labels`.
 * \throws UserError. */
[[nodiscard]] DysegClip loadLabelledRun(const std::string& folder,
                                        const std::string& pose_file,
                                        std::size_t first,
                                        std::size_t last);
}  // namespace dyslam
