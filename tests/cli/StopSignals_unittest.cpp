// SPDX-License-Identifier: BSD-3-Clause
#include "../../apps/common/StopSignals.h"

#include <gtest/gtest.h>

#include <csignal>

namespace dyslam
{
namespace
{
/** The signals that it asks for do not end the test, nor what other tests ask. */
class StopSignals : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    stop_asked = false;
    stopOnSignals();
  }
  void TearDown() override
  {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    std::signal(SIGHUP, SIG_DFL);
    stop_asked = false;
    recording_end_asked = false;
  }
};

TEST_F(StopSignals, EndTheRecordingThenTheWork)
{
  const RecordingSignal signal;
  std::raise(SIGINT);
  EXPECT_TRUE(recording_end_asked);
  EXPECT_FALSE(stop_asked);
  std::raise(SIGINT);
  EXPECT_TRUE(stop_asked);
  EXPECT_EXIT(std::raise(SIGINT), ::testing::KilledBySignal(SIGINT), "");
}

TEST_F(StopSignals, OfAnyKindCount)
{
  const RecordingSignal signal;
  std::raise(SIGTERM);
  EXPECT_TRUE(recording_end_asked);
  EXPECT_FALSE(stop_asked);
  std::raise(SIGINT);
  EXPECT_TRUE(stop_asked);
}

TEST_F(StopSignals, EndTheWorkOnceARecordingHasEnded)
{
  const RecordingSignal signal;
  RecordingSignal::recordingEnded();
  std::raise(SIGINT);
  EXPECT_FALSE(recording_end_asked);
  EXPECT_TRUE(stop_asked);
}

TEST_F(StopSignals, EndTheWorkWithoutARecording)
{
  {
    const RecordingSignal signal;
  }
  std::raise(SIGINT);
  EXPECT_TRUE(stop_asked);
}
}  // namespace
}  // namespace dyslam
