// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

namespace dyslam
{
/** What is kept of a frame until it is decided, each more than the one before. Of all but `none`:
 * index, is_keyframe, stamp, dt, clock_offset, motion, poses, T_vehicle_lidar, `moving`,
 * `moving_probability`, detections and objects. */
enum class FrameParts
{
  none,       //!< nothing: the frame is evidence for others, and is not decided itself
  points,     //!< the cloud's points, for tracking
  intensity,  //!< and intensities, for the replay
  cloud,      //!< the cloud and the scan's parts, for the map
  all         //!< the scan as well, for labels
};

/** A copy of these parts of a frame, not `none`. */
[[nodiscard]] Frame copyOf(const Frame& frame, FrameParts parts);
}  // namespace dyslam
