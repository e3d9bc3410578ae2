// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/odometry/LidarOdometry.h>

namespace dyslam
{
/** What all registrations of one scan to an earlier one share: the first frame, frames that cannot
 * be used, and the chain of motions over them. */
class ScanToScan : public LidarOdometry
{
 public:
  MotionEstimate process(const Frame& frame,
                         const Pose& T_previous_current_prediction,
                         const Matrix6& information = Matrix6::Zero()) final;
  void reset() final;

 protected:
  /** Make ready what align() and accept() need of the frame, and forget what was told of the one
   * before. Called with every frame, those in trouble (see cloudTrouble()) too. \return why it
   * cannot be used */
  virtual std::string extract(const Frame& frame) = 0;
  /** Register the frame to the reference; T_previous_current is then from the reference. */
  virtual MotionEstimate align(const Pose& T_reference_current_guess) = 0;
  /** The frame becomes the reference. \param T_reference_current the motion found, or the guess */
  virtual void accept(const Pose& T_reference_current) = 0;
  virtual void clear() = 0;
  /** Whether there is a reference, with no motion between it and the frame before this one. */
  [[nodiscard]] bool referenceIsPrevious() const
  {
    return has_reference_ && T_reference_previous_.matrix().isIdentity();
  }
  /** Of the guess in align(); zero where it is not known. */
  [[nodiscard]] const Matrix6& guessInformation() const { return guess_information_; }

 private:
  bool has_reference_ = false;
  Pose T_reference_previous_ = Pose::Identity();
  Matrix6 guess_information_ = Matrix6::Zero();
  int failures_ = 0;
};

/** Weight of each point of the frame's cloud, from what it knows of moving; empty for 1. */
[[nodiscard]] std::vector<float> pointWeights(const Frame& frame);
}  // namespace dyslam
