// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/SensorClock.h>
#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
constexpr double unix_time = 1.7e9;  // [s]

TEST(SensorClock, ManySmallStepsDoNotDrift)
{
  constexpr int columns = 1000000;
  constexpr double period = 97656e-9;  // of the columns of an Ouster [s]
  // Synchronised, of International Atomic Time, and since the lidar was switched on.
  for (const double first : {unix_time + 0.25, unix_time + 37, 100.0})
  {
    SensorClock clock;
    const double begin = clock.advance(first, unix_time);
    EXPECT_EQ(begin, first == unix_time + 0.25 ? first : unix_time);
    double stamp = begin;
    for (int i = 0; i < columns; ++i)
    {
      stamp = clock.advance(period, unix_time);
    }
    EXPECT_NEAR(stamp - begin, columns * period, 1e-6) << first;
  }
}

TEST(SensorClock, AClockThatIsSetContinuesByTheCapture)
{
  for (const double step : {unix_time, -99.0})
  {
    SensorClock clock;
    (void)clock.advance(100, unix_time);
    EXPECT_NEAR(clock.advance(0.1, unix_time + 0.12), unix_time + 0.1, 1e-6);
    EXPECT_NEAR(clock.advance(step, unix_time + 0.22), unix_time + 0.2, 1e-6);
    EXPECT_NEAR(clock.advance(0.1, unix_time + 0.33), unix_time + 0.3, 1e-6);
  }
}

TEST(SensorClock, PacketsThatWereOvertakenAndGaps)
{
  SensorClock clock;
  (void)clock.advance(0, unix_time);
  EXPECT_NEAR(clock.advance(0.002, unix_time + 0.001), unix_time + 0.002, 1e-6);
  EXPECT_NEAR(clock.advance(-0.001, unix_time + 0.002), unix_time + 0.001, 1e-6);
  EXPECT_NEAR(clock.advance(5, unix_time + 5.002), unix_time + 5.001, 1e-6);
}
}  // namespace
}  // namespace dyslam
