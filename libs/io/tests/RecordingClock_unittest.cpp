// SPDX-License-Identifier: BSD-3-Clause
#include "../src/recording/RecordingClock.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include "../src/recording/RecordingNotes.h"

namespace dyslam
{
namespace
{
TEST(RecordingClock, AScanWithoutALaterTimeIsDropped)
{
  RecordingClock clock("r");
  RecordingNotes notes;
  EXPECT_FALSE(clock.accept(std::nullopt, 0, notes).accepted);
  EXPECT_FALSE(clock.last());
  EXPECT_TRUE(clock.accept(100.0, 1, notes).accepted);
  EXPECT_FALSE(clock.accept(100.0, 2, notes).accepted);
  EXPECT_FALSE(clock.accept(99.5, 3, notes).accepted);
  EXPECT_TRUE(clock.accept(100.5, 4, notes).accepted);
  EXPECT_EQ(clock.first(), 100.0);
  EXPECT_EQ(clock.last(), 100.5);
  EXPECT_EQ(clock.shift(), 0);
  EXPECT_EQ(clock.dropped(), 3U);
  EXPECT_EQ(notes.lines("r").size(), 3U);
}

/** Scans every 0.5 s; the clock is set back by 60 s after the first two. */
TEST(RecordingClock, AClockThatWasSetBackGoesOn)
{
  RecordingClock clock("r");
  RecordingNotes notes;
  EXPECT_TRUE(clock.accept(100.0, 0, notes).accepted);
  EXPECT_TRUE(clock.accept(100.5, 1, notes).accepted);
  for (std::size_t i = 0; i < 3; ++i)
  {
    EXPECT_FALSE(clock.accept(41.0 + 0.5 * static_cast<double>(i), 2 + i, notes).accepted);
  }
  const RecordingClock::Verdict verdict = clock.accept(42.5, 5, notes);
  EXPECT_TRUE(verdict.accepted);
  EXPECT_EQ(verdict.shift, 60);
  EXPECT_EQ(clock.shift(), 60);
  EXPECT_EQ(clock.last(), 102.5);
  EXPECT_TRUE(clock.accept(43.0, 6, notes).accepted);
  EXPECT_EQ(clock.last(), 103.0);
}

TEST(RecordingClock, StampsThatStandStillAreAnError)
{
  RecordingClock clock("r");
  RecordingNotes notes;
  EXPECT_TRUE(clock.accept(100.0, 0, notes).accepted);
  for (std::size_t i = 1; i <= 10; ++i)
  {
    EXPECT_FALSE(clock.accept(100.0, i, notes).accepted);
  }
  EXPECT_THROW((void)clock.accept(100.0, 11, notes), UserError);
}
}  // namespace
}  // namespace dyslam
