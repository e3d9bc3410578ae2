// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/covariance.h>
#include <dyslam/backend/FactorGraph.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "FactorGraphProblem.h"
#include "LoopConsistency.h"

namespace dyslam
{
namespace
{
void requireType(const Key& key, bool pose)
{
  if (key.isPose() != pose)
  {
    throw std::invalid_argument("variable " + toString(key) +
                                (pose ? ": is not a pose" : ": is not a velocity"));
  }
}

void requireFinite(const Key& key, bool finite)
{
  if (!finite)
  {
    throw std::invalid_argument("variable " + toString(key) +
                                ": its value has numbers that are not finite");
  }
}

/** Sets of joined numbers. */
class DisjointSets
{
 public:
  explicit DisjointSets(std::size_t size) : parent_(size)
  {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i)
  {
    while (parent_[i] != i)
    {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  /** The smaller root stays. */
  void join(std::size_t a, std::size_t b)
  {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};
}  // namespace

void FactorGraphOptions::describe(OptionsVisitor& visitor)
{
  visitor.integer("max_iterations", max_iterations, 0, 10000, "steps of the optimisation");
  visitor.real("tolerance", tolerance, 0, 1, "stop when a step lowers the cost by less than this");
  visitor.choice(
      "loop_loss", loop_loss,
      {{"none", RobustLoss::none}, {"cauchy", RobustLoss::cauchy}, {"dcs", RobustLoss::dcs}},
      "robust loss of loop factors");
  visitor.real("loop_loss_width", loop_loss_width, 1e-6, 1e6, "whitened residual where it sets in");
  visitor.real("odometry_sigma_scale", odometry_sigma_scale, 1, 1000,
               "the odometry may be so much worse than it says before it contradicts a loop");
  visitor.choice(
      "object_loss", object_loss,
      {{"none", RobustLoss::none}, {"cauchy", RobustLoss::cauchy}, {"dcs", RobustLoss::dcs}},
      "robust loss of observations of objects");
  visitor.real("object_loss_width", object_loss_width, 1e-6, 1e6,
               "whitened residual where it sets in");
}

FactorGraph::Variable& FactorGraph::variable(const Key& key)
{
  const auto found = variables_.find(key);
  if (found == variables_.end())
  {
    throw std::out_of_range("the factor graph has no variable " + toString(key));
  }
  return found->second;
}

const FactorGraph::Variable& FactorGraph::variable(const Key& key) const
{
  return const_cast<FactorGraph*>(this)->variable(key);
}

void FactorGraph::requireNew(const Key& key) const
{
  if (contains(key))
  {
    throw std::invalid_argument("variable " + toString(key) + ": is there already");
  }
}

void FactorGraph::addPose(const Key& key, const Pose& pose)
{
  requireType(key, true);
  requireFinite(key, pose.matrix().allFinite());
  requireNew(key);
  packPose(pose, variables_[key].block.data());
}

void FactorGraph::addVelocity(const Key& key, const Vector6& twist)
{
  requireType(key, false);
  requireFinite(key, twist.allFinite());
  requireNew(key);
  Eigen::Map<Vector6>(variables_[key].block.data()) = twist;
}

void FactorGraph::addBlock(const Key& key, const std::array<double, pose_block_size>& block)
{
  requireFinite(
      key, Eigen::Map<const Eigen::Matrix<double, pose_block_size, 1>>(block.data()).allFinite());
  requireNew(key);
  variables_[key].block = block;
}

void FactorGraph::remove(const Key& key)
{
  const std::vector<FactorId> touching = variable(key).factors;
  for (const FactorId id : touching)
  {
    removeFactor(id);
  }
  variables_.erase(key);
}

Pose FactorGraph::pose(const Key& key) const
{
  return unpackPose(variable(key).block.data());
}

Vector6 FactorGraph::velocity(const Key& key) const
{
  return Eigen::Map<const Vector6>(variable(key).block.data());
}

void FactorGraph::setPose(const Key& key, const Pose& pose)
{
  requireType(key, true);
  requireFinite(key, pose.matrix().allFinite());
  packPose(pose, variable(key).block.data());
}

void FactorGraph::setVelocity(const Key& key, const Vector6& twist)
{
  requireType(key, false);
  requireFinite(key, twist.allFinite());
  Eigen::Map<Vector6>(variable(key).block.data()) = twist;
}

void FactorGraph::setFixed(const Key& key, bool fixed)
{
  variable(key).fixed = fixed;
}

bool FactorGraph::isFixed(const Key& key) const
{
  return variable(key).fixed;
}

FactorGraph::FactorId FactorGraph::add(std::unique_ptr<const Factor> factor)
{
  for (const Key& key : factor->keys())
  {
    if (!contains(key))
    {
      throw std::invalid_argument("factor of kind " + toString(factor->kind()) + ": its variable " +
                                  toString(key) + " is not in the graph");
    }
  }
  FactorId id = factors_.size();
  if (unused_.empty())
  {
    factors_.emplace_back();
  }
  else
  {
    id = unused_.back();
    unused_.pop_back();
  }
  for (const Key& key : factor->keys())
  {
    variable(key).factors.push_back(id);
  }
  factors_[id] = std::move(factor);
  ++factor_count_;
  return id;
}

void FactorGraph::removeFactor(FactorId id)
{
  for (const Key& key : factor(id).keys())
  {
    std::vector<FactorId>& ids = variable(key).factors;
    ids.erase(std::find(ids.begin(), ids.end(), id));
  }
  factors_[id].reset();
  left_out_.erase(id);
  unused_.push_back(id);
  --factor_count_;
}

const Factor& FactorGraph::factor(FactorId id) const
{
  if (id >= factors_.size() || factors_[id] == nullptr)
  {
    throw std::out_of_range("the factor graph has no factor " + std::to_string(id));
  }
  return *factors_[id];
}

const std::vector<FactorGraph::FactorId>& FactorGraph::factorsOf(const Key& key) const
{
  return variable(key).factors;
}

std::vector<FactorGraph::FactorId> FactorGraph::factorIds() const
{
  std::vector<FactorId> ids;
  ids.reserve(factor_count_);
  for (FactorId id = 0; id < factors_.size(); ++id)
  {
    if (factors_[id] != nullptr)
    {
      ids.push_back(id);
    }
  }
  return ids;
}

double FactorGraph::whitenedResidual(FactorId id) const
{
  const Factor& f = factor(id);
  std::array<const double*, max_keys_per_factor> blocks{};
  for (std::size_t i = 0; i < f.keys().size(); ++i)
  {
    blocks[i] = variable(f.keys()[i]).block.data();
  }
  return (f.whitening() * f.residual(blocks.data(), nullptr)).norm();
}

double FactorGraph::chi2() const
{
  double sum = 0;
  for (const FactorId id : factorIds())
  {
    const double residual = whitenedResidual(id);
    sum += residual * residual;
  }
  return sum;
}

void FactorGraph::holdLooseParts(std::vector<Key>& free, std::vector<std::string>& warnings) const
{
  const auto indexOf = [&free](const Key& key)
  {
    const auto found = std::lower_bound(free.begin(), free.end(), key);
    return found != free.end() && *found == key ? static_cast<std::size_t>(found - free.begin())
                                                : free.size();
  };
  // One more for everything that is held.
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
      warnings.push_back(toString(free[i]) +
                         " and what hangs on it is joined to nothing that is held: it is solved by "
                         "itself");
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
  holdLooseParts(free, warnings);
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
  // While there is contradiction, loops that do not fit stay: without a false one they may.
  for (auto worst = contradictedLoops(*this, left_out_, options.loop_loss_width,
                                      options.odometry_sigma_scale);
       !worst.empty(); worst = contradictedLoops(*this, left_out_, options.loop_loss_width,
                                                 options.odometry_sigma_scale))
  {
    solve_without(worst);
  }
  const std::set<FactorId> misfits = misfittingLoops(*this, left_out_, options.loop_loss_width);
  if (!misfits.empty())
  {
    solve_without(misfits);
  }
}

void FactorGraph::leaveOutFalseLoops(const FactorGraphOptions& options,
                                     const std::vector<Key>& free,
                                     const std::map<Key, Variable>& start,
                                     OptimisationResult& result)
{
  leaveOutContradicted(options, free, result);
  // One group of loops that agree may have won over several that are right.
  const std::set<FactorId> kept = keptLoops(*this, left_out_);
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
    if (independentGroups(*this, keptLoops(*this, left_out_)) <= groups)
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
  OptimisationResult result = optimiseVariables(options, free);
  if (options.loop_loss != RobustLoss::none)
  {
    leaveOutFalseLoops(options, free, start, result);
    result.final_chi2 = chi2();
  }
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
  for (const auto& [key, variable] : variables_)
  {
    if (!variable.fixed && (wanted.empty() || wanted.count(key) != 0))
    {
      free.push_back(key);
    }
  }
  FactorGraphOptions plain;
  plain.loop_loss = RobustLoss::none;
  plain.object_loss = RobustLoss::none;
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
        "the factors leave a direction of the factor graph open: there is no "
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
