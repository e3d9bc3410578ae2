// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/odometry/ScanMatcher.h>

namespace dyslam
{
/** Base class of registrations of a scan to an earlier one: handles the first frame, unusable
 * frames, and the chain of motions over them. */
class ScanToScan : public ScanMatcher
{
 public:
  [[nodiscard]] ScanMatch match(const Frame& frame, const MotionPrior& prior) final;
  void exchangeState(StateArchive& archive) final;

 protected:
  /** Prepares the data of the frame that align() and accept() need, and drops those of the previous
   * frame. Called with every frame, also with unusable ones (see reasonUnusable()). \return reason
   * why the frame cannot be used; empty if it can */
  virtual std::string extract(const Frame& frame) = 0;
  /** Registers the frame to the reference. \return motion from the reference to the frame */
  virtual MotionEstimate align(const Pose& T_reference_current_guess) = 0;
  /** Makes the frame the reference. \param T_reference_current estimated motion, or the guess */
  virtual void accept(const Pose& T_reference_current) = 0;
  /** Saves or loads the reference and related data. */
  virtual void exchangeReference(StateArchive& archive) = 0;
  /** ScanMatch::static_confidence of the frame that was last extracted and aligned. */
  [[nodiscard]] virtual std::vector<float> staticConfidence() const { return {}; }
  /** Whether there is a reference, with no motion between it and the previous frame. */
  [[nodiscard]] bool referenceIsPrevious() const
  {
    return has_reference_ && T_reference_previous_.matrix().isIdentity();
  }
  /** Information of the guess in align(); zero if unknown. */
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
