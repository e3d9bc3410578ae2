// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/core/Frame.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Result of a scan matcher. */
struct ScanMatch
{
  /** Its information is that of the points only, even if the matcher uses the prior. */
  MotionEstimate motion;
  /** Confidence in [0, 1] that a point is static, per cloud point; empty if the matcher gives none
   * or the frame could not be used. */
  std::vector<float> static_confidence;
};

/** Estimates the motion between consecutive frames; base class of the methods that the config
 * chooses from.
 *
 * Reads Frame::cloud and, as weights, Frame::moving_probability and Frame::static_confidence if
 * they are as long as the cloud. Not thread-safe; one object per recording.
 */
class ScanMatcher
{
 public:
  virtual ~ScanMatcher() = default;

  /** Motion from the frame of the previous call to this one.
   *
   * The first frame yields the identity, converged. A frame that cannot be used (no or too few
   * points, no agreement) yields the prior's motion, the status not_found and a reason; the next
   * motion is still relative to that frame, so that the chain of motions never breaks.
   * \param prior its motion is the initial value; its information is fused with the points by
   *   matchers whose usesPrior() is true */
  [[nodiscard]] virtual ScanMatch match(const Frame& frame, const MotionPrior& prior) = 0;
  /** Whether match() fuses the information of the prior. */
  [[nodiscard]] virtual bool usesPrior() const { return false; }
  /** Whether match() only returns the motion of the prior: the points measure nothing. */
  [[nodiscard]] virtual bool onlyPredicts() const { return false; }
  /** Saves or loads the state between frames. */
  virtual void exchangeState(StateArchive& archive) = 0;
  [[nodiscard]] virtual std::string name() const = 0;
};

/** Names that makeScanMatcher() accepts. */
[[nodiscard]] std::vector<std::string> scanMatcherNames();

/** Whether the matcher `name` is in the module `networks`; false for an unknown name. */
[[nodiscard]] bool scanMatcherNeedsNetworks(const std::string& name);

/** Makes the matcher `name` with the options of the ini section `[<name>]`.
 * \throws UserError for an unknown name, naming the nearest, and for bad options. The pool must
 * outlive the result. */
[[nodiscard]] std::unique_ptr<ScanMatcher> makeScanMatcher(const std::string& name,
                                                           ConfigLoader& config,
                                                           ThreadPool& pool);
}  // namespace dyslam
