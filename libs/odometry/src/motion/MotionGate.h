// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/odometry/Odometry.h>

#include <string>

#include "FrameContext.h"

namespace dyslam
{
/** Decides which motions of segmenter and scan matcher are accepted, by their Mahalanobis distance
 * to the prior, and how much the registration then relies on them. */
class MotionGate
{
 public:
  /** \param registers a registration to a map corrects the matcher's motion; else it is the result,
   *   and accepted whatever the prior says */
  MotionGate(const FusionOptions& options, bool registers)
      : options_(options), registers_(registers)
  {
  }

  /** Whether Frame::segmenter_motion is accepted. That is for the first scans: only while the
   * segmenter gives an appearance prior.
   * \param T_sweep_previous motion that the previous cloud was deskewed with */
  [[nodiscard]] bool acceptsSegmenterMotion(const Frame& frame, const Pose& T_sweep_previous) const;
  /** Information of a segmenter's motion that is accepted, of log(T_measured^-1 T). */
  [[nodiscard]] Matrix6 segmenterInformation() const;

  /** Why the matcher's motion, Frame::odometry, is rejected; empty if it is accepted. */
  [[nodiscard]] std::string rejectionReason(const Frame& frame, const FrameContext& context) const;

  /** Initial guess of the motion since the previous scan: the matcher's, if accepted, else the
   * prior's. */
  [[nodiscard]] Pose initialGuess(const Frame& frame, const FrameContext& context) const;
  /** Sigma of the initial guess at the first registration to a map [m].
   * \param sigma the same without the motions of segmenter and matcher [m] */
  [[nodiscard]] double initialSigma(const Frame& frame,
                                    const FrameContext& context,
                                    double sigma) const;

 private:
  FusionOptions options_;
  bool registers_;
};
}  // namespace dyslam
