// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/base/SwappedStore.h>
#include <dyslam/core/KeyframeStore.h>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "loops/LoopCandidates.h"
#include "loops/LoopVerification.h"

namespace dyslam
{
/** Loops between keyframes that are near each other at the present poses. */
struct NearLoops
{
  std::vector<Loop> accepted;
  std::size_t tried = 0;      //!< number of keyframes within `search_radius` of the other run
  std::size_t confirmed = 0;  //!< number of tried keyframes that are registered and supported
};

/** Loops found by appearance. */
struct SimilarLoops
{
  std::vector<Loop> accepted;
  std::size_t fitting = 0;  //!< number of registered loops, before others have to agree
};

/** Whether keyframe `older` of one run may be near keyframe `newer` of another. */
using NearKeyframes = std::function<bool(std::size_t older, std::size_t newer)>;

/** Finds loops between the keyframes of different runs, which one store contains successively.
 * Deterministic; not thread-safe. */
class RunLoops
{
 public:
  /** \param keyframes outlives this */
  RunLoops(const LoopCloserOptions& options, KeyframeStore& keyframes);

  /** Prepares the store's next keyframe. \param static_points vehicle frame [m] */
  void add(const std::vector<Eigen::Vector3f>& static_points);

  /** Loops from keyframes of one run to those of another by appearance alone, since the relative
   * pose of the two runs is unknown. \param near limits the search; all keyframes if it is empty */
  [[nodiscard]] SimilarLoops byAppearance(const KeyframeRange& older,
                                          const KeyframeRange& newer,
                                          const NearKeyframes& near = {});

  /** Loops to the nearest keyframe of the other run. \param reach largest expected error of the
   * relative pose of the runs at every keyframe of `newer` [m] */
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
  SwappedStore<PlaceViews> views_;  //!< views of every keyframe
};
}  // namespace dyslam
