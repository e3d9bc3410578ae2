// SPDX-License-Identifier: BSD-3-Clause
// Optimisation of a factor graph, and covariances.
#include <ceres/covariance.h>
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/core/DisjointSets.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "FactorGraphProblem.h"
#include "LoopConsistency.h"

namespace dyslam
{
void FactorGraph::fixUnconstrainedParts(std::vector<Key>& free,
                                        std::vector<std::string>& warnings) const
{
  const auto indexOf = [&free](const Key& key)
  {
    const auto found = std::lower_bound(free.begin(), free.end(), key);
    return found != free.end() && *found == key ? static_cast<std::size_t>(found - free.begin())
                                                : free.size();
  };
  // The last set is for all variables that are held fixed.
  DisjointSets sets(free.size() + 1);
  for (std::size_t i = 0; i < free.size(); ++i)
  {
    for (const FactorId id : variable(free[i]).factors)
    {
      for (const Key& key : factor(id).keys())
      {
        sets.join(i, indexOf(key));
      }
    }
  }
  const std::size_t held = sets.find(free.size());
  std::vector<Key> kept;
  for (std::size_t i = 0; i < free.size(); ++i)
  {
    const std::size_t root = sets.find(i);
    if (root != held && root == i)
    {
      warnings.push_back(
          toString(free[i]) +
          " and the variables connected to it have no fixed variable: they are solved "
          "separately");
      continue;
    }
    kept.push_back(free[i]);
  }
  free = std::move(kept);
}

OptimisationResult FactorGraph::optimiseVariables(const FactorGraphOptions& options,
                                                  const std::vector<Key>& wanted)
{
  std::vector<std::string> warnings;
  std::vector<Key> free = wanted;
  fixUnconstrainedParts(free, warnings);
  OptimisationResult result;
  result.converged = true;
  result.reason = "nothing to optimise";
  if (!free.empty())
  {
    result = FactorGraphProblem(options, free, variables_, factors_, left_out_).solve();
  }
  result.warnings = std::move(warnings);
  return result;
}

void FactorGraph::leaveOutContradicted(const FactorGraphOptions& options,
                                       const std::vector<Key>& free,
                                       OptimisationResult& result)
{
  const auto solve_without = [&](const std::set<FactorId>& loops)
  {
    left_out_.insert(loops.begin(), loops.end());
    const OptimisationResult again = optimiseVariables(options, free);
    result.iterations += again.iterations;
    result.converged = again.converged;
    result.reason = again.reason;
  };
  const auto contradicted = [&]
  { return contradictedLoops(*this, options.loop_loss_width, options.odometry_sigma_scale); };
  // Loops with large residuals stay while there is a contradicted group: without it they may fit.
  for (auto worst = contradicted(); !worst.empty(); worst = contradicted())
  {
    solve_without(worst);
  }
  const std::set<FactorId> inconsistent = inconsistentLoops(*this, options.loop_loss_width);
  if (!inconsistent.empty())
  {
    solve_without(inconsistent);
  }
}

void FactorGraph::leaveOutFalseLoops(const FactorGraphOptions& options,
                                     const std::vector<Key>& free,
                                     const std::map<Key, Variable>& start,
                                     OptimisationResult& result)
{
  leaveOutContradicted(options, free, result);
  const auto used = [this]
  {
    const std::vector<FactorId> loops = usedLoops();
    return std::set<FactorId>(loops.begin(), loops.end());
  };
  // One group of consistent but false loops may have won over several correct ones.
  const std::set<FactorId> kept = used();
  const std::size_t groups = independentGroups(*this, kept);
  if (!kept.empty() && independentGroups(*this, left_out_) > groups)
  {
    const std::map<Key, Variable> solution = variables_;
    const std::set<FactorId> solution_left_out = left_out_;
    variables_ = start;
    left_out_ = kept;
    const OptimisationResult without = optimiseVariables(options, free);
    result.iterations += without.iterations;
    leaveOutContradicted(options, free, result);
    if (independentGroups(*this, used()) <= groups)
    {
      variables_ = solution;
      left_out_ = solution_left_out;
    }
  }
  result.false_loops = left_out_.size();
  if (!left_out_.empty())
  {
    const std::vector<Key>& keys = factor(*left_out_.begin()).keys();
    result.warnings.push_back(
        std::to_string(left_out_.size()) +
        " loops contradict the rest of the graph and are left out, the first " + toString(keys[0]) +
        " -> " + toString(keys[1]));
  }
}

OptimisationResult FactorGraph::optimise(const FactorGraphOptions& options)
{
  std::vector<Key> free;
  for (const auto& [key, variable] : variables_)
  {
    if (!variable.fixed)
    {
      free.push_back(key);
    }
  }
  left_out_.clear();
  const std::map<Key, Variable> start = variables_;
  const double initial_chi2 = chi2();
  OptimisationResult result = optimiseVariables(options, free);
  if (options.loop_loss != RobustLoss::none)
  {
    leaveOutFalseLoops(options, free, start, result);
  }
  // Also of factors between fixed variables and of loops that are left out.
  result.initial_chi2 = initial_chi2;
  result.final_chi2 = chi2();
  return result;
}

OptimisationResult FactorGraph::optimise(const FactorGraphOptions& options,
                                         const std::set<Key>& wanted)
{
  std::vector<Key> free;
  for (const Key& key : wanted)
  {
    if (!variable(key).fixed)
    {
      free.push_back(key);
    }
  }
  return optimiseVariables(options, free);
}

std::vector<Matrix6> FactorGraph::covariances(const std::vector<Key>& keys,
                                              const std::set<Key>& wanted)
{
  std::vector<Key> free;
  const auto addFree = [&](const Key& key, const Variable& variable)
  {
    if (!variable.fixed)
    {
      free.push_back(key);
    }
  };
  for (const Key& key : wanted)
  {
    if (const auto found = variables_.find(key); found != variables_.end())
    {
      addFree(key, found->second);
    }
  }
  if (wanted.empty())
  {
    for (const auto& [key, variable] : variables_)
    {
      addFree(key, variable);
    }
  }
  FactorGraphOptions plain;
  plain.loop_loss = RobustLoss::none;
  plain.object_loss = RobustLoss::none;
  plain.gnss_loss = RobustLoss::none;
  FactorGraphProblem problem(plain, free, variables_, factors_, left_out_);
  std::vector<std::pair<const double*, const double*>> pairs;
  for (const Key& key : keys)
  {
    if (std::binary_search(free.begin(), free.end(), key))
    {
      const double* block = variable(key).block.data();
      pairs.emplace_back(block, block);
    }
  }
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  options.apply_loss_function = false;
  ceres::Covariance covariance(options);
  if (!pairs.empty() && !covariance.Compute(pairs, &problem.problem()))
  {
    throw std::runtime_error(
        "the factors do not constrain a direction of the factor graph: there is no "
        "covariance of " +
        toString(keys.front()));
  }
  std::vector<Matrix6> result;
  for (const Key& key : keys)
  {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block = Matrix6::Zero();
    const double* values = variable(key).block.data();
    if (std::binary_search(free.begin(), free.end(), key))
    {
      covariance.GetCovarianceBlockInTangentSpace(values, values, block.data());
    }
    result.emplace_back(block);
  }
  return result;
}
}  // namespace dyslam
