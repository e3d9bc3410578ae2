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

extern "C" void onSignal(int number)
{
  if (!is_recording.exchange(false))
  {
    stop_asked = true;
    return;
  }
  recording_end_asked = true;
  // The system has reset the action of a signal whose second one kills.
  struct sigaction action = {};
  action.sa_handler = onSignal;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(number, &action, nullptr);
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
  struct sigaction action = {};
  action.sa_handler = onSignal;
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
