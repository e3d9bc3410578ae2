// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/KeyframeStore.h>

#include <cstddef>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Pose of one keyframe in the frame of another, by the present estimate. */
[[nodiscard]] Pose poseBetween(const KeyframeStore& keyframes, std::size_t from, std::size_t to);

/** Error of the cycle of both loops and the two pieces of trajectory between their ends: identity
 * if they agree. \return pose of the end of the cycle in the frame of a.to. */
[[nodiscard]] Pose cycleError(const Loop& a, const Loop& b, const KeyframeStore& keyframes);

/** Delays loops until other loops of nearby keyframes agree with them. */
class LoopAgreement
{
 public:
  /** \param min_support number of other loops that must agree \param appearance_support the same
   * for loops by appearance \param window number of keyframes that count as nearby */
  LoopAgreement(int min_support, int appearance_support, int window)
      : min_support_(min_support), appearance_support_(appearance_support), window_(window)
  {
  }

  /** Adds a loop that passed its registration. \param keyframes poses for the motion between this
   * loop and others */
  void add(const Loop& loop, const KeyframeStore& keyframes);
  /** The newly decided loops: accepted, or unsupported after `window` keyframes. */
  [[nodiscard]] std::vector<Loop> decide(std::size_t newest_keyframe);
  /** The loops still waiting, as unsupported. */
  [[nodiscard]] std::vector<Loop> finish();

  void exchangeState(StateArchive& archive);

 private:
  struct Entry
  {
    Loop loop;
    int support = 0;
    bool accepted = false;  //!< accepted; kept for a while to support others
  };

  int min_support_;
  int appearance_support_;
  int window_;
  std::vector<Entry> entries_;
};
}  // namespace dyslam
