// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Why scans failed, reasons that differ in their numbers alone counted together. */
class Reasons
{
 public:
  void add(const std::string& reason);
  [[nodiscard]] std::size_t total() const { return total_; }
  /** An example of the most frequent kind; empty if there was none. */
  [[nodiscard]] std::string mostFrequent() const;
  void exchangeState(StateArchive& archive);

 private:
  std::map<std::string, std::pair<std::size_t, std::string>> kinds_;  //!< count, example
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
