// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/graphs/CNetworkOfPoses.h>

namespace dyslam
{
/** Baseline: optimises a pose graph with Ceres in the setup of its pose-graph example. Automatic
 * derivatives of translation and quaternion, a quaternion manifold, sparse Cholesky, default
 * settings, 200 iterations, starting from the graph's poses (chained edges where it has none). The
 * error is g2o's, whitened with the upper Cholesky factor. Indefinite information matrices are
 * projected as PoseGraphSolver does.
 * \param limit time limit [s] \return number of iterations */
int solveByPlainCeres(mrpt::graphs::CNetworkOfPoses3DInf& graph, double limit);
}  // namespace dyslam
