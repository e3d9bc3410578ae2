// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/FactorType.h>

#include <array>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "PoseManifold.h"

namespace dyslam
{
/** Some variables of a factor graph and the factors that touch them, as a Ceres problem. The values
 * are changed in place. */
class FactorGraphProblem
{
 public:
  /** \param free variables to be optimised; sorted \param variables all variables of the graph;
   *  outlives the problem \param left_out factors that are ignored */
  FactorGraphProblem(const FactorGraphOptions& options,
                     const std::vector<Key>& free,
                     std::map<Key, FactorGraph::Variable>& variables,
                     const std::vector<std::unique_ptr<const Factor>>& factors,
                     const std::set<FactorGraph::FactorId>& left_out);

  /** Narrows the robust loss of loops and localisations step by step, then solves. */
  OptimisationResult solve();
  [[nodiscard]] double chi2() const;
  [[nodiscard]] ceres::Problem& problem() { return problem_; }

 private:
  void add(const Factor& factor, std::map<Key, FactorGraph::Variable>& variables);
  ceres::Solver::Summary solve(double loop_loss_width, int max_iterations, double tolerance);
  int narrowLoopLoss();
  /** Largest whitened residual of loops and localisations. */
  [[nodiscard]] double worstPlace() const;

  struct Block
  {
    const Factor* factor;
    FactorLoss loss;
    std::array<double*, max_keys_per_factor> values;
  };
  /** Loss function that the block has at present; null: none. */
  ceres::LossFunction* lossOf(const Block& block);

  const FactorGraphOptions& options_;
  PoseManifold manifold_;
  ceres::LossFunctionWrapper loop_loss_;
  std::map<std::pair<RobustLoss, double>, std::unique_ptr<ceres::LossFunction>> losses_;
  ceres::Problem problem_;
  std::vector<Block> blocks_;
  bool has_places_ = false;
};
}  // namespace dyslam
