// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/PoseGraph.h>

namespace dyslam
{
/** The ego poses with their odometry and loop factors as a pose graph of MRPT; nodes are numbered
 * as the keyframes. Without loops that the optimisation left out, and without objects, velocities
 * and satellite positions, which MRPT's graph can't represent. */
[[nodiscard]] PoseGraph poseGraphView(const FactorGraph& graph);
}  // namespace dyslam
