// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace dyslam
{
// Set by the signal handler, which can't access anything else.
extern std::atomic<bool> stop_asked;
extern std::atomic<bool> recording_end_asked;  //!< see RecordingSignal
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set it");

/** Effect of a second signal. */
enum class SecondSignal
{
  kills,   //!< ends the program
  ignored  //!< for programs that wait for others, which get the signal too
};

/** Ctrl-C, kill and a terminal that is lost end the work after the current scan. A hang-up that is
 * ignored (nohup) stays so. */
void stopOnSignals(SecondSignal second = SecondSignal::kills);

/** During its lifetime the first signal ends a recording that goes on (`recording_end_asked`), not
 * the work, which the next signal ends. At most one at a time. */
class RecordingSignal
{
 public:
  /** \pre stopOnSignals() is called, before or afterwards. */
  RecordingSignal();
  ~RecordingSignal();
  RecordingSignal(const RecordingSignal&) = delete;
  RecordingSignal& operator=(const RecordingSignal&) = delete;
  /** The recording has ended by itself: the first signal ends the work. */
  static void recordingEnded();
};
}  // namespace dyslam
