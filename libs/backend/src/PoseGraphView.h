// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/PoseGraph.h>

namespace dyslam
{
/** The ego poses with their odometry and loop factors as MRPT has a pose graph; nodes are the
 * keyframes' numbers. Left out: loops that the optimisation found false, and objects and
 * velocities, which MRPT does not know. */
[[nodiscard]] PoseGraph poseGraphView(const FactorGraph& graph);
}  // namespace dyslam
