// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <csignal>

namespace dyslam
{
// The only thing a signal can reach.
inline std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set it");

/** What a second signal does. */
enum class SecondSignal
{
  kills,   //!< as usual
  ignored  //!< for programs that wait for others, which get the signal too
};

/** Ctrl-C, kill and a terminal that is lost end the work after the current scan. A hang-up that is
 * ignored (nohup) stays so. */
inline void stopOnSignals(SecondSignal second = SecondSignal::kills)
{
  struct sigaction action = {};
  action.sa_handler = [](int) { stop_asked = true; };
  action.sa_flags =
      SA_RESTART | (second == SecondSignal::kills ? static_cast<int>(SA_RESETHAND) : 0);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction earlier = {};
  sigaction(SIGHUP, nullptr, &earlier);
  if (earlier.sa_handler != SIG_IGN)
  {
    sigaction(SIGHUP, &action, nullptr);
  }
}
}  // namespace dyslam
