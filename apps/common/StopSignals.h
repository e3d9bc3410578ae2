// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace dyslam
{
// Set by the signal handler, which can't access anything else.
extern std::atomic<bool> stop_asked;
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
}  // namespace dyslam
