// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/solver.h>

#include <algorithm>

namespace dyslam
{
/** Levenberg-Marquardt with a sparse Cholesky factorisation, silent.
 *
 * The trust region is large from the start, so that the first step is nearly that of Gauss-Newton.
 * \param tolerance stop when a step lowers the cost by less than this fraction */
[[nodiscard]] inline ceres::Solver::Options sparseSolverOptions(int max_iterations,
                                                                double tolerance,
                                                                int threads)
{
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = tolerance;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.initial_trust_region_radius = 1e8;
  options.num_threads = threads;
  options.logging_type = ceres::SILENT;
  return options;
}

/** Number of steps that were tried; Ceres also lists the initial state as an iteration. */
[[nodiscard]] inline int stepsOf(const ceres::Solver::Summary& summary)
{
  return std::max(0, static_cast<int>(summary.iterations.size()) - 1);
}
}  // namespace dyslam
