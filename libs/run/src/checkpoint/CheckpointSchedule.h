// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "ScanSum.h"

namespace dyslam
{
/** What the front end's thread adds to a checkpoint, after the frame behind which it is made. */
struct BegunCheckpoint
{
  std::string front_end;  //!< Pipeline::exchangeFrontEndState()
  std::string method;     //!< Pipeline::summary()
  ScanSum scans;          //!< so far
  bool is_last = false;   //!< the run is stopped behind it: SlamRun::finish() leaves it
};

/** Schedules checkpoints, and passes the front end's part from its thread to that of the back
 * end. */
class CheckpointSchedule
{
 public:
  /** \param seconds between checkpoints; 0: none. */
  explicit CheckpointSchedule(double seconds) : seconds_(seconds) {}

  // Called in the front end's thread:
  /** Whether a checkpoint is due; if so, schedules the next one.
   * \param at_once it is due now, unless checkpoints are off */
  [[nodiscard]] bool due(bool at_once);
  void begin(std::size_t frame, BegunCheckpoint begun);

  // Called in the back end's thread:
  /** Records the duration of a checkpoint [s]: the interval is adapted, so that checkpoints take at
   * most a twentieth of the time for any size of the state. */
  void recordDuration(double seconds) { cost_ = seconds; }
  /** What was begun at this frame. */
  [[nodiscard]] std::optional<BegunCheckpoint> take(std::size_t frame);

 private:
  double seconds_;
  std::atomic<double> cost_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::map<std::size_t, BegunCheckpoint> begun_;  //!< by Frame::index
};
}  // namespace dyslam
