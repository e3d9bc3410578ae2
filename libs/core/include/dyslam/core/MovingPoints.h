// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <vector>

namespace dyslam
{
/** For each point of the frame's cloud, whether it is likelier to move than `threshold`; none is
 * where nothing was segmented. */
[[nodiscard]] std::vector<bool> likelyMoving(const Frame& frame, double threshold);

/** The same, and the points of the detections that tracked objects in motion were seen by. */
[[nodiscard]] std::vector<bool> movingPoints(const Frame& frame, double threshold);
}  // namespace dyslam
