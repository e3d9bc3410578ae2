// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/PoseGraph.h>

namespace dyslam
{
/** The ego poses with their odometry and loop factors as MRPT has a pose graph; nodes are the
 * keyframes' numbers. Objects and velocities are left out: MRPT knows neither. */
[[nodiscard]] PoseGraph poseGraphView(const FactorGraph& graph);
}  // namespace dyslam
