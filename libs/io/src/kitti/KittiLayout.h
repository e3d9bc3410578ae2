// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/io/KittiConverter.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** The files of a KITTI recording and its ground truth, for writing scan by scan. */
struct KittiLayout
{
  struct Entry
  {
    std::string scan;        //!< .bin file
    std::string times;       //!< file of point times, empty if there is none
    std::string labels;      //!< .label file, empty if there is none
    std::size_t number = 0;  //!< in KITTI's counting: other files refer to it
    double stamp = 0;        //!< stamp of the scan [s]
    std::optional<Pose> T_world_lidar;
  };
  std::vector<Entry> entries;
  std::string pose_file;  //!< file of the true poses; empty without
  PoseOrigin pose_origin;
  std::vector<ImuSample> imu;      //!< of oxts, if the options want it, in order of time
  std::vector<GnssFix> gnss;       //!< of oxts, if the options want it, in order of time
  bool has_point_times = false;    //!< some scan has a file of point times
  bool has_unused_oxts = false;    //!< oxts is there, and the options want nothing of it
  std::vector<LabelledBox> boxes;  //!< lidar frame; LabelledBox::frame is an Entry::number
  std::vector<std::string> notes;
  std::vector<std::string> warnings;
};

/** Finds the files of an official or plain layout, or those the options name, and reads the truth.
 * \throws UserError. */
[[nodiscard]] KittiLayout readKittiLayout(const std::string& input,
                                          const KittiConverterOptions& options);
}  // namespace dyslam
