// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

namespace dyslam
{
/** Parts of a frame that are kept until its labels are decided; each value keeps more than the one
 * before. All but `none` keep index, is_keyframe, stamp, dt, clock_offset, motion, poses,
 * T_vehicle_lidar, `moving`, `moving_probability`, detections and objects. */
enum class FrameParts
{
  none,       //!< nothing: the frame is evidence for others, but gets no labels itself
  points,     //!< the cloud's points, for tracking
  intensity,  //!< and intensities, for the replay
  cloud,      //!< the cloud and the scan's parts, for the map
  all         //!< the scan as well, for labels
};

/** A copy of `parts` of a frame. \pre `parts` is not `none`. */
[[nodiscard]] Frame copyOf(const Frame& frame, FrameParts parts);
}  // namespace dyslam
