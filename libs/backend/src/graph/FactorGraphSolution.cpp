// SPDX-License-Identifier: BSD-3-Clause
// Optimisation of a factor graph, and covariances.
#include <ceres/covariance.h>
#include <ceres/manifold.h>
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/base/DisjointSets.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include "FactorGraphProblem.h"
#include "PoseManifold.h"
#include "loops/LoopOutlierRejection.h"

namespace dyslam
{
namespace
{
/** Variables to be optimised: the given ones without the first of every part of the graph that has
 * no fixed variable, which holds this part. \param free sorted \param warnings one per such part */
std::vector<Key> withFixedGauge(const FactorGraph& graph,
                                const std::vector<Key>& free,
                                std::vector<std::string>& warnings)
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
    for (const FactorGraph::FactorId id : graph.factorsOf(free[i]))
    {
      for (const Key& key : graph.factor(id).keys())
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
      const std::string name = toString(free[i]);
      warnings.push_back(name + " and the variables connected to it have no fixed variable: " +
                         name + " is held where it is");
      continue;
    }
    kept.push_back(free[i]);
  }
  return kept;
}

using Directions = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;

/** The directions of a variable's tangent that factors can measure, as columns: all six, but of the
 * vertical the rotations about the two level axes alone, of the bias the three that have a meaning.
 */
Directions measurableDirections(const Key& key, const double* block)
{
  switch (key.kind)
  {
    case VariableKind::vertical:
    {
      Directions tilt = Directions::Zero(6, 2);
      tilt.bottomRows<3>() = unpackPose(block).linear().transpose().leftCols<2>();
      return tilt;
    }
    case VariableKind::accelerometer_bias:
      return Directions::Identity(6, 3);
    default:
      return Directions::Identity(6, 6);
  }
}

using BlockPairs = std::vector<std::pair<const double*, const double*>>;

/** The variables of the graph that are not fixed. \param wanted only those of them; empty: all
 * \return sorted */
std::vector<Key> freeKeys(const FactorGraph& graph, const std::set<Key>& wanted)
{
  std::vector<Key> free;
  const auto add = [&free](const Key& key, const FactorGraph::Variable& variable)
  {
    if (!variable.fixed)
    {
      free.push_back(key);
    }
  };
  for (const Key& key : wanted)
  {
    const auto found = graph.variables().find(key);
    if (found != graph.variables().end())
    {
      add(key, found->second);
    }
  }
  if (wanted.empty())
  {
    for (const auto& [key, variable] : graph.variables())
    {
      add(key, variable);
    }
  }
  return free;
}

/** The blocks of the covariance matrix for the marginals of `keys` that are free, each once: Ceres
 * aborts the program if a pair is there twice. \param free sorted */
BlockPairs marginalBlocks(const FactorGraph& graph,
                          const std::vector<Key>& free,
                          const std::vector<Key>& keys)
{
  BlockPairs pairs;
  std::set<Key> listed;
  for (const Key& key : keys)
  {
    if (std::binary_search(free.begin(), free.end(), key) && listed.insert(key).second)
    {
      const double* block = graph.variables().at(key).block.data();
      pairs.emplace_back(block, block);
    }
  }
  return pairs;
}

ceres::Covariance::Options covarianceOptions()
{
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  options.apply_loss_function = false;
  return options;
}

/** Changes of a pose or six numbers in some directions of the tangent, given as columns of unit
 * length that are perpendicular to each other. */
class DirectionsManifold final : public ceres::Manifold
{
 public:
  DirectionsManifold(bool is_pose, Directions directions)
      : is_pose_(is_pose), directions_(std::move(directions))
  {
  }

  [[nodiscard]] int AmbientSize() const override
  {
    return is_pose_ ? pose_block_size : velocity_block_size;
  }
  [[nodiscard]] int TangentSize() const override { return static_cast<int>(directions_.cols()); }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override
  {
    const Vector6 step = directions_ * Eigen::Map<const Eigen::VectorXd>(delta, directions_.cols());
    if (is_pose_)
    {
      return PoseManifold().Plus(x, step.data(), x_plus_delta);
    }
    Eigen::Map<Vector6>{x_plus_delta} = Eigen::Map<const Vector6>(x) + step;
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override
  {
    Eigen::Map<Jacobian> map(jacobian, AmbientSize(), TangentSize());
    map.setZero();
    map.topRows<6>() = directions_;
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override
  {
    Vector6 step = Eigen::Map<const Vector6>(y) - Eigen::Map<const Vector6>(x);
    if (is_pose_)
    {
      PoseManifold().Minus(y, x, step.data());
    }
    Eigen::Map<Eigen::VectorXd>(y_minus_x, directions_.cols()) = directions_.transpose() * step;
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override
  {
    Eigen::Map<Jacobian> map(jacobian, TangentSize(), AmbientSize());
    map.setZero();
    map.leftCols<6>() = directions_.transpose();
    return true;
  }

 private:
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  bool is_pose_;
  Directions directions_;
};
}  // namespace

OptimisationResult FactorGraph::optimise(const FactorGraphOptions& options)
{
  std::set<Key> free;
  for (const auto& [key, variable] : variables_)
  {
    if (!variable.fixed)
    {
      free.insert(free.end(), key);
    }
  }
  left_out_.clear();
  const Solution start = solution();
  const double initial_chi2 = chi2();
  OptimisationResult result = optimise(options, free);
  if (options.loop_loss != RobustLoss::none)
  {
    LoopOutlierRejection(*this, options, std::move(free)).run(start, result);
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
  std::vector<std::string> warnings;
  free = withFixedGauge(*this, free, warnings);
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

std::vector<Matrix6> FactorGraph::covariances(const std::vector<Key>& keys,
                                              const std::set<Key>& wanted)
{
  const std::vector<Key> free = freeKeys(*this, wanted);
  FactorGraphOptions plain;
  plain.loop_loss = RobustLoss::none;
  plain.object_loss = RobustLoss::none;
  plain.gnss_loss = RobustLoss::none;
  std::vector<std::unique_ptr<DirectionsManifold>> manifolds;  // outlive the problem
  FactorGraphProblem problem(plain, free, variables_, factors_, left_out_);
  for (const Key& key : free)
  {
    double* block = variable(key).block.data();
    Directions directions = measurableDirections(key, block);
    if (directions.cols() < 6)
    {
      manifolds.push_back(
          std::make_unique<DirectionsManifold>(key.isPose(), std::move(directions)));
      problem.problem().SetManifold(block, manifolds.back().get());
    }
  }
  const BlockPairs pairs = marginalBlocks(*this, free, keys);
  ceres::Covariance covariance(covarianceOptions());
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
    Matrix6 in_all = Matrix6::Zero();
    const double* values = variable(key).block.data();
    if (std::binary_search(free.begin(), free.end(), key))
    {
      const Directions directions = measurableDirections(key, values);
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block(
          directions.cols(), directions.cols());
      covariance.GetCovarianceBlockInTangentSpace(values, values, block.data());
      in_all = directions * block * directions.transpose();
    }
    result.emplace_back(in_all);
  }
  return result;
}
}  // namespace dyslam
