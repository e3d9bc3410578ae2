// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Association.h>

namespace dyslam
{
/** Whether the bodies of two trajectories have the same axes. */
enum class BodyAxes
{
  same,              //!< same axes, or too little motion to decide
  estimate_camera,   //!< estimate in camera axes (z ahead), reference in lidar axes (x ahead)
  reference_camera,  //!< reference in camera axes (z ahead), estimate in lidar axes (x ahead)
  differ             //!< the motions are equally long, but in other directions
};

/** Compares the directions of motion, each in the frame of its body.
 *
 * `differ` means that the mean cosine of the angle between them is below 0.5; the camera cases that
 * it is above 0.9 after turning camera axes to lidar axes, and that the camera moves along its z
 * axis (a body that is turned by a yaw of 90 degrees moves like a camera otherwise). Noise and
 * drift change directions only by degrees. Of motions that differ in length, as of an estimate that
 * was lost, the camera cases are those in which one body moves along its z axis and the other along
 * its x axis, both with a mean cosine above 0.9. */
[[nodiscard]] BodyAxes compareBodyAxes(const PosePairs& pairs);
}  // namespace dyslam
