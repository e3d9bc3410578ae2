// SPDX-License-Identifier: BSD-3-Clause
#include "LoopOutlierRejection.h"

#include <dyslam/base/Printable.h>

#include <vector>

#include "LoopConsistency.h"

namespace dyslam
{
LoopOutlierRejection::Loops LoopOutlierRejection::used() const
{
  const std::vector<FactorGraph::FactorId> loops = graph_.usedLoops();
  return {loops.begin(), loops.end()};
}

void LoopOutlierRejection::optimise(OptimisationResult& result)
{
  const OptimisationResult again = graph_.optimise(options_, free_);
  result.iterations += again.iterations;
  result.converged = again.converged;
  result.reason = again.reason;
}

void LoopOutlierRejection::leaveOut(const Loops& loops, OptimisationResult& result)
{
  for (const FactorGraph::FactorId loop : loops)
  {
    graph_.leaveOut(loop);
  }
  optimise(result);
}

void LoopOutlierRejection::leaveOutContradicted(OptimisationResult& result)
{
  const auto contradicted = [this]
  { return contradictedLoops(graph_, options_.loop_loss_width, options_.odometry_sigma_scale); };
  // Loops with large residuals stay while there is a contradicted group: without it they may fit.
  for (Loops worst = contradicted(); !worst.empty(); worst = contradicted())
  {
    leaveOut(worst, result);
  }
  const Loops inconsistent = inconsistentLoops(graph_, options_.loop_loss_width);
  if (!inconsistent.empty())
  {
    leaveOut(inconsistent, result);
  }
}

void LoopOutlierRejection::tryOthers(const Loops& kept,
                                     const FactorGraph::Solution& start,
                                     OptimisationResult& result)
{
  const FactorGraph::Solution found = graph_.solution();
  OptimisationResult others = result;
  graph_.restore({start.blocks, kept});
  optimise(others);
  leaveOutContradicted(others);
  if (independentGroups(graph_, used()) > independentGroups(graph_, kept))
  {
    result = others;
    return;
  }
  graph_.restore(found);
  result.iterations = others.iterations;
}

void LoopOutlierRejection::run(const FactorGraph::Solution& start, OptimisationResult& result)
{
  leaveOutContradicted(result);
  const Loops kept = used();
  if (!kept.empty() &&
      independentGroups(graph_, graph_.leftOutLoops()) > independentGroups(graph_, kept))
  {
    tryOthers(kept, start, result);
  }
  const Loops& left_out = graph_.leftOutLoops();
  result.false_loops = left_out.size();
  if (!left_out.empty())
  {
    const std::vector<Key>& keys = graph_.factor(*left_out.begin()).keys();
    result.warnings.push_back(counted(left_out.size(), "loop") +
                              " left out that the rest of the graph contradicts; the first: " +
                              toString(keys[0]) + " -> " + toString(keys[1]));
  }
}
}  // namespace dyslam
