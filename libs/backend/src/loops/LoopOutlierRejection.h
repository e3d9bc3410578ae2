// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>

#include <set>
#include <utility>

namespace dyslam
{
/** Leaves the loops out of a graph that odometry, other loops and localisations contradict.
 *
 * While a group of neighbouring loops is contradicted (LoopConsistency.h), the worst one is left
 * out and the rest is solved again; at the end, single loops that do not fit. If more groups were
 * left out than kept, the solution without the kept ones is tried, too: one group of consistent but
 * false loops may have won over several correct ones.
 */
class LoopOutlierRejection
{
 public:
  /** \param graph outlives this \param free variables that are optimised */
  LoopOutlierRejection(FactorGraph& graph, const FactorGraphOptions& options, std::set<Key> free)
      : graph_(graph), options_(options), free_(std::move(free))
  {
  }

  /** \pre the graph was optimised with all loops \param start values before that \param result of
   * that optimisation; updated, with a warning if loops are left out */
  void run(const FactorGraph::Solution& start, OptimisationResult& result);

 private:
  using Loops = std::set<FactorGraph::FactorId>;

  [[nodiscard]] Loops used() const;
  void optimise(OptimisationResult& result);
  void leaveOut(const Loops& loops, OptimisationResult& result);
  void leaveOutContradicted(OptimisationResult& result);
  /** Solves without the loops `kept` and with the others; the graph is as before unless more groups
   * of loops are consistent then. */
  void tryOthers(const Loops& kept, const FactorGraph::Solution& start, OptimisationResult& result);

  FactorGraph& graph_;
  const FactorGraphOptions& options_;
  std::set<Key> free_;
};
}  // namespace dyslam
