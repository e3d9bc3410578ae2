// SPDX-License-Identifier: BSD-3-Clause
#include "StopSignals.h"

#include <csignal>

namespace dyslam
{
std::atomic<bool> stop_asked{false};

void stopOnSignals(SecondSignal second)
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
