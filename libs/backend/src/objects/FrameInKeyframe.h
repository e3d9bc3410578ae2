// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>

namespace dyslam
{
/** Pose of a frame relative to the newest keyframe at that time. */
struct FrameInKeyframe
{
  double stamp = 0;  //!< UNIX time [s]
  double time = 0;   //!< Frame::time(): ascends even if the clock of the stamps is set back [s]
  std::size_t keyframe = 0;
  Pose T_keyframe_frame = Pose::Identity();
};
}  // namespace dyslam
