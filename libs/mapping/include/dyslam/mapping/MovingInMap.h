// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/mapping/StaticMap.h>

#include <vector>

namespace dyslam
{
/** Which points of the cloud stay out of the map: those that move, and those in the boxes of moving
 * objects. */
[[nodiscard]] std::vector<bool> movingInMap(const Frame& frame, const StaticMapOptions& options);
}  // namespace dyslam
