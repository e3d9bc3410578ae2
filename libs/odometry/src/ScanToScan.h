// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/odometry/ScanMatcher.h>

namespace dyslam
{
/** Common part of all registrations of one scan to an earlier one: the first frame, frames that
 * cannot be used, and the chain of motions over them. */
class ScanToScan : public ScanMatcher
{
 public:
  [[nodiscard]] ScanMatch match(const Frame& frame, const MotionPrior& prior) final;
  void exchangeState(StateArchive& archive) final;

 protected:
  /** Prepares what align() and accept() need of the frame, and forgets what was kept of the one
   * before. Called with every frame, unusable ones (see reasonUnusable()) too. \return why it
   * cannot be used */
  virtual std::string extract(const Frame& frame) = 0;
  /** Register the frame to the reference; T_previous_current is then from the reference. */
  virtual MotionEstimate align(const Pose& T_reference_current_guess) = 0;
  /** The frame becomes the reference. \param T_reference_current the motion found, or the guess */
  virtual void accept(const Pose& T_reference_current) = 0;
  /** The reference, and what else is kept of it. */
  virtual void exchangeReference(StateArchive& archive) = 0;
  /** As ScanMatch::static_confidence, of the frame last extracted and aligned. */
  [[nodiscard]] virtual std::vector<float> staticConfidence() const { return {}; }
  /** Whether there is a reference, with no motion between it and the frame before this one. */
  [[nodiscard]] bool referenceIsPrevious() const
  {
    return has_reference_ && T_reference_previous_.matrix().isIdentity();
  }
  /** Of the guess in align(); zero where it is not known. */
  [[nodiscard]] const Matrix6& guessInformation() const { return guess_information_; }

 private:
  [[nodiscard]] MotionEstimate find(const Frame& frame, const MotionPrior& prior);

  bool has_reference_ = false;
  Pose T_reference_previous_ = Pose::Identity();
  Matrix6 guess_information_ = Matrix6::Zero();
  int failures_ = 0;
};

/** Weight in [0, 1] of each point of the frame's cloud: 1 - moving_probability, times
 * static_confidence; empty for 1. */
[[nodiscard]] std::vector<float> pointWeights(const Frame& frame);
}  // namespace dyslam
