// SPDX-License-Identifier: BSD-3-Clause
// Clocks that are set during a recording, and scans that are missing.
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanClock.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <cmath>
#include <string>

#include "TestScene.h"

namespace dyslam
{
namespace
{
constexpr double period = 0.1;
constexpr std::size_t enough_scans = 12;  // scans that show the sensor's rate
constexpr std::size_t after = 8;

struct Event
{
  double speed = 0;                   // of the vehicle [m/s]
  double passed = 0;                  // between the scans before and after [s]
  double step = 0;                    // of the clock in that time [s]
  double offset = 0;                  // expected of Frame::clock_offset afterwards [s]
  std::string warned;                 // expected in the warnings; empty: no warning
  std::size_t before = enough_scans;  // scans before what happens
};

class ScanClockTest : public testing::TestWithParam<Event>
{
};

TEST_P(ScanClockTest, MotionGoesOn)
{
  const Event& event = GetParam();
  const test::StreetScene scene;
  ThreadPool pool(2);
  mrpt::system::CTimeLogger times(false);
  Config config;
  ConfigLoader loader(config);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  Odometry odometry(loader, pool, times);
  double time = 0;
  double clock = 100;
  for (std::size_t i = 0; i < event.before + after; ++i)
  {
    time += i == event.before ? event.passed : period;
    clock += i == event.before ? event.passed + event.step : period;
    Pose T = Pose::Identity();
    T.translation().x() = event.speed * time;
    Pose T_sweep = Pose::Identity();
    T_sweep.translation().x() = event.speed * period;
    Frame frame;
    frame.index = i;
    frame.scan = scene.scan(T, 0.01, static_cast<unsigned>(i + 1), T_sweep);
    frame.scan.stamp = clock;
    odometry.predict(frame);
    const auto prepare = [&](const Pose& T_previous_current, double dt)
    { return preprocessor.prepare(frame.scan, T_previous_current, dt, frame.sweep_duration); };
    frame.cloud = prepare(frame.prior.T_previous_current, frame.dt);
    odometry.resolveInterval(frame, prepare);
    odometry.estimate(frame);
    odometry.integrate(frame);
    EXPECT_TRUE(frame.motion.converged()) << i << ": " << frame.motion.reason;
    EXPECT_NEAR(frame.T_odom_vehicle.translation().x(), event.speed * (time - period), 0.1) << i;
    if (i >= event.before)
    {
      EXPECT_NEAR(frame.clock_offset, event.offset, 0.01) << i;
    }
  }
  std::string warnings;
  for (const std::string& line : odometry.warnings())
  {
    warnings += line;
  }
  EXPECT_NE(warnings.find(event.warned), std::string::npos) << warnings;
  EXPECT_EQ(warnings.empty(), event.warned.empty()) << warnings;
}

INSTANTIATE_TEST_SUITE_P(
    Clocks,
    ScanClockTest,
    testing::Values(Event{8, period, 0, 0, ""},
                    Event{8, period, 0.5, 0.5, "set before scan 12, by 0.500 s"},
                    Event{8, period, 3600, 3600, "set before scan 12, by 3600.000 s"},
                    Event{8, period, -0.05, -0.05, "by -0.050 s"}));

/** As soon as the vehicle's motion is known. */
INSTANTIATE_TEST_SUITE_P(
    AtTheBeginning,
    ScanClockTest,
    testing::Values(Event{8, period, 3600, 3600, "set before scan 4, by 3600.000 s", 4},
                    Event{8, period, -20, -20, "scan 1, by -20.000 s", 1},
                    Event{8, period, -20, -20, "scan 3, by -20.000 s", 3},
                    Event{8, period, -period, -period, "scan 3, by -0.100 s", 3},
                    Event{8, 0.6, 0, 0, "", 4},
                    Event{0, 5, 0, 0, "", 4}));

INSTANTIATE_TEST_SUITE_P(Gaps,
                         ScanClockTest,
                         testing::Values(Event{8, 0.2, 0, 0, ""},
                                         Event{8, 0.6, 0, 0, ""},
                                         Event{0, 36000, 0, 0, ""},
                                         Event{0, 5, 0, 0, ""}));

/** Along a street a scan is also registered metres from its place, but not as well as usual. */
TEST(Gaps, AScanRegisteredAtAWrongPlaceIsNoClockStep)
{
  constexpr double speed = 8;
  constexpr double gap = 3;
  test::StreetScene scene;
  for (int house = 0; house < 15; ++house)  // beyond the scene's own
  {
    const double x = 120 + 17 * house + 2 * std::sin(5 * house);
    scene.add({x, 9, 0}, {x + 13, 15, 7});
    scene.add({x + 6, -16, 0}, {x + 17, -10, 8});
  }
  ThreadPool pool(2);
  mrpt::system::CTimeLogger times(false);
  Config config;
  config.set("odometry.start_speed=8");
  ConfigLoader loader(config);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  Odometry odometry(loader, pool, times);
  double time = 0;
  for (std::size_t i = 0; i < enough_scans + 1; ++i)
  {
    const double passed = i == 0 ? 0 : i < enough_scans ? period : gap;
    time += passed;
    Frame frame;
    frame.scan =
        scene.scan(poseFromYpr(180 + speed * time, 0, 0, 0, 0, 0), 0.01,
                   static_cast<unsigned>(i + 1), poseFromYpr(speed * period, 0, 0, 0, 0, 0));
    frame.scan.stamp = 100 + time;
    odometry.predict(frame);
    const auto prepare = [&](const Pose& T_previous_current, double dt)
    { return preprocessor.prepare(frame.scan, T_previous_current, dt, frame.sweep_duration); };
    frame.cloud = prepare(frame.prior.T_previous_current, frame.dt);
    odometry.resolveInterval(frame, prepare);
    EXPECT_NEAR(frame.clock_offset, 0, 1e-6) << i;
    EXPECT_NEAR(frame.dt, passed, 1e-6) << i;
    odometry.estimate(frame);
    odometry.integrate(frame);
  }
}

/** The motion over a gap is predicted for a part of it and does not show the velocity. */
TEST(Gaps, TheVelocityIsKeptWithoutRegistration)
{
  ThreadPool pool(1);
  mrpt::system::CTimeLogger times(false);
  Config config;
  config.set("odometry.method=constant_velocity");
  config.set("odometry.start_speed=8");
  config.set("refine.method=none");
  ConfigLoader loader(config);
  Odometry odometry(loader, pool, times);
  const auto predicted = [&odometry](double stamp)
  {
    Frame frame;
    frame.scan.stamp = stamp;
    odometry.predict(frame);
    odometry.resolveInterval(frame, [](const Pose&, double) { return Cloud(); });
    odometry.estimate(frame);
    odometry.integrate(frame);
    return frame.prior.T_previous_current.translation().x();
  };
  double stamp = 100;
  for (std::size_t i = 0; i < enough_scans; ++i)
  {
    (void)predicted(stamp);
    stamp += period;
  }
  stamp += 5;
  EXPECT_NEAR(predicted(stamp), 8 * ScanClock::max_extrapolation, 1e-6);
  EXPECT_NEAR(predicted(stamp + period), 8 * period, 1e-6);
}

/** A sweep lasts one period, also after scans that are missing. */
TEST(ScanClock, SweepsLastAsLongAsTheSensorTurns)
{
  ScanClock clock;
  EXPECT_EQ(clock.nextSweep(100), 0);
  double stamp = 100;
  for (int i = 0; i < 8; ++i)
  {
    stamp += period;
    EXPECT_NEAR(clock.nextSweep(stamp), period, 1e-9);
  }
  stamp += 4 * period;
  EXPECT_NEAR(clock.nextSweep(stamp), period, 1e-9);
  EXPECT_NEAR(clock.interval(), 4 * period, 1e-9);
  EXPECT_NEAR(clock.nextSweep(stamp + period), period, 1e-9);
}

/** Intervals that are multiples of the period: the sensor turns at its rate, and an interval that
 * occurred before is no step of the clock. */
TEST(ScanClock, TheRateIsKnownWhereScansAreMissing)
{
  ScanClock clock;
  double stamp = 100;
  (void)clock.nextSweep(stamp);
  for (const int periods : {1, 2, 3, 2, 2, 3, 2, 1, 2})
  {
    stamp += periods * period;
    (void)clock.nextSweep(stamp);
  }
  EXPECT_NEAR(clock.period(), period, 1e-9);
  for (const int periods : {3, 1, 2})
  {
    stamp += periods * period;
    clock.advance(stamp);
    EXPECT_FALSE(clock.isDoubtful()) << periods;
    EXPECT_NEAR(clock.sweepDuration(), period, 1e-9) << periods;
    clock.settle(clock.interval());
  }
  clock.advance(stamp + 7 * period);
  EXPECT_TRUE(clock.isDoubtful());
  ASSERT_EQ(clock.warnings().size(), 1U);
  EXPECT_EQ(clock.warnings()[0].find("about 7 of 21 scans are missing"), 0U) << clock.warnings()[0];
}

TEST(ScanClock, SingleMissingScansAreNotReported)
{
  ScanClock clock;
  double stamp = 100;
  for (int i = 0; i < 40; ++i)
  {
    (void)clock.nextSweep(stamp);
    stamp += i == 20 ? 3 * period : period;
  }
  EXPECT_TRUE(clock.warnings().empty());
}

/** A first sweep that is cut, and a late stamp: one interval is half as long as the others. */
TEST(ScanClock, SingleShortIntervalsAreNotTheRate)
{
  constexpr int late = 17;
  ScanClock clock;
  EXPECT_EQ(clock.nextSweep(100), 0);
  double stamp = 100 + period / 2;
  EXPECT_NEAR(clock.nextSweep(stamp), period / 2, 1e-9);
  for (int i = 0; i < 40; ++i)
  {
    stamp += period;
    EXPECT_NEAR(clock.nextSweep(i == late ? stamp + period / 2 : stamp), period, 1e-9) << i;
  }
  EXPECT_TRUE(clock.warnings().empty());
}

/** Stamps that are half a period late or early, now and then: no scan is missing. */
TEST(ScanClock, ShortIntervalsBesideLongOnesAreNotTheRate)
{
  for (const double off : {period / 2, -period / 2})
  {
    ScanClock clock;
    for (int i = 0; i < 60; ++i)
    {
      const double duration = clock.nextSweep(100 + i * period + (i % 6 == 5 ? off : 0));
      EXPECT_TRUE(i < 7 || std::abs(duration - period) < 1e-9) << off << " " << i;
    }
    EXPECT_TRUE(clock.warnings().empty());
  }
}

/** Stamps that jitter are no multiples of a period. */
TEST(ScanClock, TheRateOfUnevenStampsIsTheMedian)
{
  ScanClock clock;
  double stamp = 100;
  for (const double interval : {0.1, 0.07, 0.1, 0.13, 0.1, 0.09, 0.1, 0.1})
  {
    (void)clock.nextSweep(stamp);
    stamp += interval;
  }
  EXPECT_NEAR(clock.period(), 0.1, 1e-9);
  clock.advance(stamp + 0.05);
  EXPECT_TRUE(clock.isDoubtful());
}
}  // namespace
}  // namespace dyslam
