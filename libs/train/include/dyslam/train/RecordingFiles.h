// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Core>
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
  std::string calib_file;    //!< KITTI's calib.txt, if the poses are of its camera 0; else empty
  std::string label_folder;  //!< SemanticKITTI labels, may be empty
  std::size_t first = 0;     //!< first scan
  std::size_t last = 0;      //!< last scan, included
  bool deskew = false;       //!< deskew sweeps clockwise from straight behind, as KITTI's HDL-64E
};

/** Parses "folder;poses;first;last[;deskew][;labels=folder][;calib=file]", paths relative to
 * `base`. \param field setting that the text is from, for the message \throws UserError. */
[[nodiscard]] RecordingDescription parseRecording(const std::string& text,
                                                  const std::string& base,
                                                  const std::string& field);

/** All poses of the pose file, T_world_lidar; those of a camera are converted. \throws UserError,
 * also if a recording without calibration drives along z, or one with a calibration along x: its
 * poses are those of the other sensor. */
[[nodiscard]] std::vector<Pose> readLidarPoses(const RecordingDescription& description);

/** Points of a sweep clockwise from straight behind, transformed to its middle. \param motion of
 * the sensor during the sweep */
[[nodiscard]] std::vector<Eigen::Vector3f> deskewByAzimuth(std::vector<Eigen::Vector3f> points,
                                                           const Pose& motion);

/** Motion of the sensor into scan `k`, as T_before_k; into scan 0 that of the following step, and
 * none for a single pose. */
[[nodiscard]] Pose motionInto(const std::vector<Pose>& T_world_lidar, std::size_t k);
}  // namespace dyslam
