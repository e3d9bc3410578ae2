// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Backend.h>
#include <dyslam/backend/FactorGraph.h>

#include <cstddef>
#include <set>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Optimises a growing graph of keyframes for the loops that come in.
 *
 * A loop that is consistent with odometry and the loops before it moves the newest keyframes alone,
 * while all others are held fixed, so that its cost does not grow with the run. All keyframes are
 * optimised, and false loops searched for, where it is not, and from time to time: whenever the
 * graph has grown by a fixed share, which is a bounded number of times per keyframe.
 */
class LoopCorrection
{
 public:
  /** \param graph outlives this; its ego poses are numbered from 0 on */
  LoopCorrection(const BackendOptions& options,
                 const FactorGraphOptions& solver,
                 FactorGraph& graph)
      : options_(options), solver_(solver), graph_(graph)
  {
  }

  /** A loop factor that the graph has now. */
  void add(FactorGraph::FactorId loop);
  /** Whether the loops added since the last correction require one. */
  [[nodiscard]] bool isDue() const;
  /** Whether there are loops that were in no optimisation of all keyframes. */
  [[nodiscard]] bool isAnyOpen() const { return open_loops_ > 0; }

  /** \param keyframes in the graph
   *  \param others variables that are optimised with the newest keyframes
   *  \return the first keyframe that may have moved; all later ones may have, too */
  std::size_t correct(std::size_t keyframes, const std::set<Key>& others);
  /** Optimises all that is not fixed. */
  void correctAll(std::size_t keyframes);
  /** Of the last optimisation of everything; default before the first. */
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
  std::vector<FactorGraph::FactorId> waiting_;  //!< since the last correction
  double worst_residual_ = 0;                   //!< of those when they came, whitened
  std::size_t open_loops_ = 0;                  //!< since the last optimisation of everything
  std::size_t keyframes_then_ = 0;              //!< at that optimisation
  OptimisationResult last_;
};
}  // namespace dyslam
