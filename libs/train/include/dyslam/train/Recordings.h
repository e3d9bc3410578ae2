// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/train/PairSource.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** Points of a .bin file (float32 x y z intensity); those that are no returns stay, as NaN.
 * \throws UserError. */
[[nodiscard]] std::vector<Eigen::Vector3f> readBinPoints(const std::string& path);

/** Poses of a text file of 12 numbers a line (3x4, row-major). \throws UserError. */
[[nodiscard]] std::vector<Pose> readPoses12(const std::string& path);

/** One training or validation stretch of a folder of numbered scans. */
struct RecordingDescription
{
  std::string folder;        //!< of the .bin files
  std::string pose_file;     //!< one pose per scan of the folder
  std::string label_folder;  //!< SemanticKITTI labels, may be empty
  std::size_t first = 0;
  std::size_t last = 0;  //!< included
  bool deskew = false;   //!< sweep clockwise from straight behind, as HDL-64E's at KITTI
};

/** The scans of a description, in memory. */
struct Recording
{
  std::string name;
  std::vector<std::vector<Eigen::Vector3f>> scans;
  std::vector<std::vector<PointLabel>> labels;  //!< empty, or as `scans`
  std::vector<Pose> T_world_scan;
};

/** \param by_own_motion deskew by the truth's motion of the same step (training); else by that of
 * the step before, as a running odometry would (validation). \throws UserError. */
[[nodiscard]] Recording loadRecording(const RecordingDescription& description, bool by_own_motion);

/** "folder;poses;first;last[;deskew][;labels=folder]", paths relative to `base`. \throws UserError.
 */
[[nodiscard]] RecordingDescription parseRecording(const std::string& text, const std::string& base);

/** Scans of a folder whose names end in .bin, sorted. \throws UserError if there is none. */
[[nodiscard]] std::vector<std::string> binFiles(const std::string& folder);
}  // namespace dyslam
