// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/tracking/MovingLabels.h>

namespace dyslam
{
/** Marks the points in the box of a moving object (vehicle frame) as moving by prediction, unless
 * most of them are labelled moving already. Labels with hindsight know better than a box what is
 * certainly static, such as a wall that the box has drifted into, and the road below it: such
 * points remain static. */
void markMissed(const Box& box, MovingLabels labels, Frame& frame);
}  // namespace dyslam
