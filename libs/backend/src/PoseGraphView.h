// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/PoseGraph.h>

namespace dyslam
{
/** The ego poses with their odometry and loop factors as a pose graph of MRPT; nodes are the
 * keyframes' numbers. Left out: loops that the optimisation rejected, and objects, velocities and
 * satellite positions, which MRPT does not know. */
[[nodiscard]] PoseGraph poseGraphView(const FactorGraph& graph);
}  // namespace dyslam
