// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace dyslam
{
// The only thing a signal can reach.
extern std::atomic<bool> stop_asked;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set it");

/** What a second signal does. */
enum class SecondSignal
{
  kills,   //!< as usual
  ignored  //!< for programs that wait for others, which get the signal too
};

/** Ctrl-C, kill and a terminal that is lost end the work after the current scan. A hang-up that is
 * ignored (nohup) stays so. */
void stopOnSignals(SecondSignal second = SecondSignal::kills);
}  // namespace dyslam
