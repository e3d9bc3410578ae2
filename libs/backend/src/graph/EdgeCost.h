// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include <memory>

#include "EdgeError.h"
#include "GraphData.h"
#include "PoseManifold.h"

namespace dyslam
{
/** Whitened error of one edge between two pose blocks. */
[[nodiscard]] std::unique_ptr<ceres::CostFunction> makeEdgeCost(ErrorCoordinates coordinates,
                                                                const GraphEdge& edge);

/** Whitened error (x, y, heading) of an edge of a planar graph between blocks (x, y, heading). */
[[nodiscard]] std::unique_ptr<ceres::CostFunction> makePlanarEdgeCost(const GraphEdge& edge);
}  // namespace dyslam
