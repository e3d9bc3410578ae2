// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/BackendOptions.h>
#include <dyslam/backend/FactorGraph.h>

#include <cstddef>
#include <set>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Optimises a growing graph of keyframes for new loops.
 *
 * For a loop that is consistent with odometry and earlier loops, only the newest keyframes are
 * optimised and all others are held fixed, so that its cost does not grow with the run. All
 * keyframes are optimised, and false loops searched for, if a loop is not consistent, and for any
 * loop once the graph has grown by a fixed fraction (a bounded number of times per keyframe).
 */
class LoopCorrection
{
 public:
  /** \param graph outlives this; its ego poses are numbered from 0 */
  LoopCorrection(const BackendOptions& options,
                 const FactorGraphOptions& solver,
                 FactorGraph& graph)
      : options_(options), solver_(solver), graph_(graph)
  {
  }

  /** Registers a loop or localisation that was added to the graph. */
  void add(FactorGraph::FactorId loop);
  /** Forgets one that was removed from the graph. */
  void remove(FactorGraph::FactorId loop);
  /** Whether the loops added since the last correction require a correction. */
  [[nodiscard]] bool isDue() const;
  /** Whether there are loops that were in no optimisation of all keyframes. */
  [[nodiscard]] bool isAnyOpen() const { return open_loops_ > 0; }

  /** \param keyframes number of keyframes in the graph
   *  \param others variables that are optimised together with the newest keyframes
   *  \return the first keyframe that may have moved; all later ones may have, too */
  std::size_t correct(std::size_t keyframes, const std::set<Key>& others);
  /** Optimises all variables that are not fixed. */
  void correctAll(std::size_t keyframes);
  /** Result of the last optimisation of all variables; default before the first. */
  void restoreLast(const OptimisationResult& result) { last_ = result; }
  [[nodiscard]] const OptimisationResult& last() const { return last_; }

  void exchangeState(StateArchive& archive);

 private:
  /** \return whether the new loops fit after optimising the keyframes from `first` on; if not,
   * these are unchanged. */
  [[nodiscard]] bool correctNewest(std::size_t first,
                                   std::size_t keyframes,
                                   const std::set<Key>& others);

  BackendOptions options_;
  FactorGraphOptions solver_;
  FactorGraph& graph_;
  std::vector<FactorGraph::FactorId> waiting_;  //!< loops since the last correction
  double worst_residual_ = 0;                   //!< largest whitened residual of them when added
  std::size_t open_loops_ = 0;                  //!< loops since all variables were optimised
  std::size_t keyframes_then_ = 0;              //!< keyframes when all variables were optimised
  OptimisationResult last_;
};
}  // namespace dyslam
