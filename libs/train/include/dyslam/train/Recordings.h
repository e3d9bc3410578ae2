// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/train/PairSource.h>
#include <dyslam/train/RecordingFiles.h>

#include <string>
#include <vector>

namespace dyslam
{
/** The scans of a description, in memory. */
struct Recording
{
  std::string name;  //!< of the folder above that of the scans
  std::vector<std::vector<Eigen::Vector3f>> scans;
  std::vector<std::vector<PointLabel>> labels;  //!< empty, or as `scans`
  std::vector<Pose> T_world_scan;
};

/** Reads a recording. \param by_own_motion deskew each scan by the true motion of its own step
 * (training); else by that of the step before, as an online odometry would (validation). \throws
 * UserError, also for fewer than two scans, and if one is missing that has a pose. */
[[nodiscard]] Recording loadRecording(const RecordingDescription& description, bool by_own_motion);
}  // namespace dyslam
