// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/mapping/StaticMap.h>

#include <vector>

namespace dyslam
{
/** Which points of the cloud are left out of the map, one value per point: moving points, and
 * points in the boxes of moving objects. */
[[nodiscard]] std::vector<bool> movingInMap(const Frame& frame, const StaticMapOptions& options);
}  // namespace dyslam
