// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/graphs/CNetworkOfPoses.h>

namespace dyslam
{
/** Baseline solver: Ceres in the usual setup of its pose-graph example. Automatic derivatives of
 * translation and quaternion, a quaternion manifold, sparse Cholesky, default settings, 200
 * iterations, starting from the graph's poses (chained edges where it has none). The error is g2o's
 * and is whitened with the upper Cholesky factor.
 * \param limit time after which it gives up [s]
 * \return number of iterations. Indefinite information matrices are projected as by
 * PoseGraphSolver. */
int solveByPlainCeres(mrpt::graphs::CNetworkOfPoses3DInf& graph, double limit);
}  // namespace dyslam
