// SPDX-License-Identifier: BSD-3-Clause
#include "LoopCorrection.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <array>
#include <map>

namespace dyslam
{
void LoopCorrection::add(FactorGraph::FactorId loop)
{
  waiting_.push_back(loop);
  worst_residual_ = std::max(worst_residual_, graph_.whitenedResidual(loop));
  ++open_loops_;
}

void LoopCorrection::remove(FactorGraph::FactorId loop)
{
  waiting_.erase(std::remove(waiting_.begin(), waiting_.end(), loop), waiting_.end());
}

bool LoopCorrection::isDue() const
{
  return waiting_.size() >= static_cast<std::size_t>(options_.loops_to_optimise) ||
         (!waiting_.empty() && worst_residual_ > options_.residual_to_optimise);
}

std::size_t LoopCorrection::correct(std::size_t keyframes, const std::set<Key>& others)
{
  const auto window = static_cast<std::size_t>(options_.correction_keyframes);
  const auto limit = static_cast<std::size_t>(static_cast<double>(keyframes_then_) *
                                              (1 + options_.correction_growth));
  const std::size_t first = std::max<std::size_t>(1, keyframes - std::min(keyframes, window));
  if (window > 0 && keyframes <= limit && correctNewest(first, keyframes, others))
  {
    waiting_.clear();
    worst_residual_ = 0;
    return first;
  }
  correctAll(keyframes);
  return 0;
}

void LoopCorrection::correctAll(std::size_t keyframes)
{
  last_ = graph_.optimise(solver_);
  waiting_.clear();
  worst_residual_ = 0;
  open_loops_ = 0;
  keyframes_then_ = keyframes;
}

bool LoopCorrection::correctNewest(std::size_t first,
                                   std::size_t keyframes,
                                   const std::set<Key>& others)
{
  std::set<Key> free = others;
  for (std::size_t i = first; i < keyframes; ++i)
  {
    free.insert(Key::ego(i));
  }
  std::map<Key, std::array<double, pose_block_size>> before;
  for (const Key& key : free)
  {
    before.emplace(key, graph_.variables().at(key).block);
  }
  double chi2_of_loops = 0;
  for (const FactorGraph::FactorId id : waiting_)
  {
    const double residual = graph_.whitenedResidual(id);
    chi2_of_loops += residual * residual;
  }
  const OptimisationResult result = graph_.optimise(solver_, free);
  // Increase of chi2 by the loops, to be compared with the expectation for noise.
  const double increase = result.final_chi2 - (result.initial_chi2 - chi2_of_loops);
  const double width = solver_.loop_loss_width;
  if (increase <= 2 * width * width * static_cast<double>(waiting_.size()))
  {
    return true;
  }
  for (const auto& [key, block] : before)
  {
    graph_.setBlock(key, block);
  }
  return false;
}

void LoopCorrection::exchangeState(StateArchive& archive)
{
  archive(waiting_, worst_residual_, open_loops_, keyframes_then_, last_);
}
}  // namespace dyslam
