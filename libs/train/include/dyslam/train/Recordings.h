// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/train/PairSource.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** One training or validation range of a folder of numbered scans. */
struct RecordingDescription
{
  std::string folder;        //!< folder of the .bin files
  std::string pose_file;     //!< one pose per scan of the folder
  std::string label_folder;  //!< SemanticKITTI labels, may be empty
  std::size_t first = 0;     //!< first scan
  std::size_t last = 0;      //!< last scan, included
  bool deskew = false;       //!< deskew sweeps clockwise from straight behind, as KITTI's HDL-64E
};

/** The scans of a description, in memory. */
struct Recording
{
  std::string name;
  std::vector<std::vector<Eigen::Vector3f>> scans;
  std::vector<std::vector<PointLabel>> labels;  //!< empty, or as `scans`
  std::vector<Pose> T_world_scan;
};

/** Reads a recording. \param by_own_motion deskew each scan by the true motion of its own step
 * (training); else by that of the step before, as an online odometry would (validation). \throws
 * UserError, also for fewer than two scans. */
[[nodiscard]] Recording loadRecording(const RecordingDescription& description, bool by_own_motion);

/** Parses "folder;poses;first;last[;deskew][;labels=folder]", paths relative to `base`. \param
 * field setting that the text is from, for the message \throws UserError. */
[[nodiscard]] RecordingDescription parseRecording(const std::string& text,
                                                  const std::string& base,
                                                  const std::string& field);
}  // namespace dyslam
