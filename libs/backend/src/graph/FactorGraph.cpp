// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
void requireType(const Key& key, bool pose)
{
  if (key.isPose() != pose)
  {
    throw std::invalid_argument("variable " + toString(key) +
                                (pose ? ": is not a pose" : ": is a pose"));
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
}  // namespace

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

void FactorGraph::addVector(const Key& key, const Vector6& vector)
{
  requireType(key, false);
  requireFinite(key, vector.allFinite());
  requireNew(key);
  Eigen::Map<Vector6>(variables_[key].block.data()) = vector;
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

Vector6 FactorGraph::vector(const Key& key) const
{
  return Eigen::Map<const Vector6>(variable(key).block.data());
}

void FactorGraph::setPose(const Key& key, const Pose& pose)
{
  requireType(key, true);
  requireFinite(key, pose.matrix().allFinite());
  packPose(pose, variable(key).block.data());
}

void FactorGraph::setBlock(const Key& key, const std::array<double, pose_block_size>& block)
{
  requireFinite(
      key, Eigen::Map<const Eigen::Matrix<double, pose_block_size, 1>>(block.data()).allFinite());
  variable(key).block = block;
}

FactorGraph::Solution FactorGraph::solution() const
{
  Solution solution;
  for (const auto& [key, variable] : variables_)
  {
    solution.blocks.emplace(key, variable.block);
  }
  solution.left_out = left_out_;
  return solution;
}

void FactorGraph::restore(const Solution& solution)
{
  for (const auto& [key, block] : solution.blocks)
  {
    setBlock(key, block);
  }
  left_out_ = solution.left_out;
}

void FactorGraph::setFixed(const Key& key, bool fixed)
{
  variable(key).fixed = fixed;
}

FactorGraph::FactorId FactorGraph::add(std::unique_ptr<const Factor> factor)
{
  if (!types_.contains(factor->type()))
  {
    throw std::invalid_argument(std::string("factor of kind ") + factor->type().name +
                                ": its type is not in the table of the graph's types");
  }
  for (const Key& key : factor->keys())
  {
    if (!contains(key))
    {
      throw std::invalid_argument(std::string("factor of kind ") + factor->type().name +
                                  ": its variable " + toString(key) + " is not in the graph");
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

void FactorGraph::leaveOut(FactorId loop)
{
  if (factor(loop).type().left_out_line == nullptr)
  {
    throw std::invalid_argument("factor " + std::to_string(loop) + ": is no loop");
  }
  left_out_.insert(loop);
}

std::vector<FactorGraph::FactorId> FactorGraph::usedLoops() const
{
  std::vector<FactorId> loops = factorIds();
  loops.erase(
      std::remove_if(loops.begin(), loops.end(),
                     [this](FactorId id) { return !factor(id).is<LoopFactor>() || isLeftOut(id); }),
      loops.end());
  return loops;
}

double FactorGraph::whitenedResidual(FactorId id) const
{
  const Factor& f = factor(id);
  std::array<const double*, max_keys_per_factor> blocks{};
  for (std::size_t i = 0; i < f.keys().size(); ++i)
  {
    blocks[i] = variable(f.keys()[i]).block.data();
  }
  return f.whitenedResidual(blocks.data()).norm();
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

void FactorGraph::exchangeState(StateArchive& archive)
{
  archive(variables_, unused_, factor_count_, left_out_);
  std::size_t count = factors_.size();
  archive(count);
  if (archive.isLoading())
  {
    factors_.clear();
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    const bool is_there = !archive.isLoading() && factors_[i] != nullptr;
    FactorData data = is_there ? factors_[i]->data() : FactorData();
    std::uint8_t type = is_there ? types_.numberOf(factors_[i]->type()) : std::uint8_t{0};
    archive(type, data.keys, data.measurement, data.further, data.information);
    if (archive.isLoading())
    {
      factors_.push_back(types_.make(type, data));
    }
  }
}
}  // namespace dyslam
