// SPDX-License-Identifier: BSD-3-Clause
#include "StopSignals.h"

#include <csignal>

namespace dyslam
{
std::atomic<bool> stop_asked{false};
std::atomic<bool> recording_end_asked{false};

namespace
{
/** Whether the next signal ends a recording. */
std::atomic<bool> is_recording{false};
/** Whether a signal after the one that ends the work kills. */
std::atomic<bool> second_kills{true};

extern "C" void onSignal(int number)
{
  if (is_recording.exchange(false))
  {
    recording_end_asked = true;
    return;
  }
  stop_asked = true;
  if (second_kills)
  {
    std::signal(number, SIG_DFL);
  }
}
}  // namespace

RecordingSignal::RecordingSignal()
{
  recording_end_asked = false;
  is_recording = true;
}

RecordingSignal::~RecordingSignal()
{
  is_recording = false;
}

void RecordingSignal::recordingEnded()
{
  is_recording = false;
}

void stopOnSignals(SecondSignal second)
{
  second_kills = second == SecondSignal::kills;
  struct sigaction action = {};
  action.sa_handler = onSignal;
  action.sa_flags = SA_RESTART;
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
