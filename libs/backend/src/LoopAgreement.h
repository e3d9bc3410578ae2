// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/KeyframeStore.h>

#include <cstddef>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Present estimate of the pose of one keyframe in the frame of another. */
[[nodiscard]] Pose poseBetween(const KeyframeStore& keyframes, std::size_t from, std::size_t to);

/** Both loops and the two pieces of trajectory between their ends make a cycle, which ends where it
 * began if they agree. \return where it ends, in the frame of a.to. */
[[nodiscard]] Pose cycleError(const Loop& a, const Loop& b, const KeyframeStore& keyframes);

/** Delays loops until other loops of nearby keyframes agree with them. */
class LoopAgreement
{
 public:
  /** \param min_support other loops that must agree \param appearance_support the same for loops
   * by appearance \param window "nearby", in keyframes */
  LoopAgreement(int min_support, int appearance_support, int window)
      : min_support_(min_support), appearance_support_(appearance_support), window_(window)
  {
  }

  /** A loop that passed its registration. \param keyframes whose poses make the odometry between
   * this loop and others */
  void add(const Loop& loop, const KeyframeStore& keyframes);
  /** The loops decided by now: accepted, or unsupported after having waited for `window`. */
  [[nodiscard]] std::vector<Loop> decide(std::size_t newest_keyframe);
  /** The loops still waiting, as unsupported. */
  [[nodiscard]] std::vector<Loop> finish();

  void exchangeState(StateArchive& archive);

 private:
  struct Entry
  {
    Loop loop;
    int support = 0;
    bool accepted = false;  //!< kept for a while to support others
  };

  int min_support_;
  int appearance_support_;
  int window_;
  std::vector<Entry> entries_;
};
}  // namespace dyslam
