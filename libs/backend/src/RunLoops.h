// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/SwappedStore.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "LoopCandidates.h"
#include "LoopVerification.h"

namespace dyslam
{
/** Loops found near one another, by the present poses. */
struct NearLoops
{
  std::vector<Loop> accepted;
  std::size_t tried = 0;      //!< keyframes with one of the other run within `search_radius`
  std::size_t confirmed = 0;  //!< of those, registered and supported
};

/** Loops found by appearance. */
struct SimilarLoops
{
  std::vector<Loop> accepted;
  std::size_t fitting = 0;  //!< registered, accepted or not: others need to agree
};

/** Finds loops between the keyframes of different runs, which lie in one store one after the other.
 * Deterministic; not thread-safe. */
class RunLoops
{
 public:
  /** \param keyframes outlives this */
  RunLoops(const LoopCloserOptions& options, KeyframeStore& keyframes);

  /** Prepares the store's next keyframe. \param static_points vehicle frame [m] */
  void add(const std::vector<Eigen::Vector3f>& static_points);

  /** Loops from keyframes of one run to another's, by appearance alone: positions are not compared,
   * since the relative pose of the two runs is unknown. */
  [[nodiscard]] SimilarLoops byAppearance(const KeyframeRange& older, const KeyframeRange& newer);

  /** Loops to the nearest keyframe of the other run. \param reach for every keyframe of `newer`,
   * largest expected error of the poses [m] */
  [[nodiscard]] NearLoops byPosition(const KeyframeRange& older,
                                     const KeyframeRange& newer,
                                     const std::vector<double>& reach);

  /** Whether two loops between the same runs agree on their relative pose, up to the drift in
   * between. */
  [[nodiscard]] bool agree(const Loop& a, const Loop& b) const;

 private:
  [[nodiscard]] Loop verify(const LoopCandidate& candidate,
                            std::size_t keyframe,
                            const KeyframeRange& older,
                            bool by_appearance) const;

  LoopCloserOptions options_;
  KeyframeStore& keyframes_;
  LoopCandidates candidates_;
  SwappedStore<PlaceViews> views_;  //!< of every keyframe
};
}  // namespace dyslam
