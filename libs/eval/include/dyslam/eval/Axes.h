// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Association.h>

namespace dyslam
{
/** Whether the bodies of two trajectories have the same axes. */
enum class BodyAxes
{
  same,              //!< or there is too little motion to tell
  estimate_camera,   //!< the estimate's are a camera's (z ahead), the reference's a lidar's (x
                     //!< ahead)
  reference_camera,  //!< the other way round
  differ             //!< the motions are equally long, but in other directions
};

/** Compares the directions of motion, each in the frame of its body.
 *
 * "Differ" means that the mean cosine of the angle between them is below 0.5; "camera" that the
 * camera's axes, turned to a lidar's, make it more than 0.9. Noise and drift do not: they change
 * directions by degrees. */
[[nodiscard]] BodyAxes compareBodyAxes(const PosePairs& pairs);
}  // namespace dyslam
