// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Why scans failed, reasons that differ in their numbers alone counted together. */
class Reasons
{
 public:
  struct Kind
  {
    std::size_t count = 0;
    std::string example;  //!< the last one
    FailureCause cause = FailureCause::estimation;
  };

  /** \param failed an estimate that found no motion */
  void add(const MotionEstimate& failed);
  [[nodiscard]] std::size_t total() const { return total_; }
  /** The most frequent kind; of count 0 if there was none. */
  [[nodiscard]] Kind mostFrequent() const;
  void exchangeState(StateArchive& archive);

 private:
  std::map<std::string, Kind> kinds_;  //!< by the reason without its numbers
  std::size_t total_ = 0;
};

/** Statistics of the frames of a run. */
struct RunStatistics
{
  void add(const Frame& frame);
  void exchangeState(StateArchive& archive);

  /** From the first scan's start to the last one's end, if all last as long as they are apart [s].
   */
  [[nodiscard]] double recordingTime() const;

  /** Ground truth in the map frame, which begins at the trajectory's first pose. */
  [[nodiscard]] Trajectory referenceInMap(const Trajectory& trajectory) const;

  /** Warnings although nothing failed; one sentence each.
   * \param has_labels the run had labels of an earlier one (dyseg.labels) */
  [[nodiscard]] std::vector<std::string> warnings(bool has_labels) const;

  /** The one among them that advises a second pass, as the traffic is dense; empty without. */
  [[nodiscard]] std::string secondPassAdvice(bool has_labels) const;

  /** Why the result is unusable, if more than half of the scans could not be registered; else
   * empty.
   * \param has_ini an ini was given, which may be the reason */
  [[nodiscard]] std::string failure(bool has_ini) const;

  /** How far the result can be trusted: "unusable" (there is a failure()), "doubtful" (more than a
   * fifth of the scans could not be registered, or the local map was restarted; the warnings say
   * so) or "usable". */
  [[nodiscard]] std::string verdict() const;

  std::size_t frames = 0;
  double first_time = 0;  //!< Frame::time() of the first frame [s]
  double last_time = 0;
  Reasons registration_failures;  //!< of frames whose motion was predicted, not measured
  std::size_t map_restarts = 0;   //!< of the local map, after failures in a row
  std::size_t unregistered_keyframes = 0;
  std::size_t not_settled = 0;  //!< registered frames whose iterations ended too early
  Reasons odometry_failures;
  std::size_t points = 0;         //!< of all clouds
  std::size_t moving_points = 0;  //!< of these, by the causal labels
  std::size_t detections = 0;     //!< of all scans
  Trajectory reference;           //!< ground truth as recorded

 private:
  /** Registration failed on more scans than this share of all. */
  [[nodiscard]] bool failedOnMoreThan(double share) const;
  /** "N of M scans could not be registered: `consequence`; most often because: ..." */
  [[nodiscard]] std::string registrationSentence(const std::string& consequence) const;
};
}  // namespace dyslam
