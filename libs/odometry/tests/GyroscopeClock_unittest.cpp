// SPDX-License-Identifier: BSD-3-Clause
#include "motion/GyroscopeClock.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace dyslam
{
namespace
{
constexpr double seconds_per_scan = 0.1;     //!< [s]
constexpr double seconds_per_sample = 0.01;  //!< [s]
constexpr double longest_gap = 0.25;         //!< [s]

using RateAt = std::function<Eigen::Vector3d(double)>;

/** Turns of a car on a road that is not smooth [rad/s]. */
Eigen::Vector3d streetRate(double t)
{
  return {0.03 * std::sin(8.3 * t), 0.04 * std::sin(9.9 * t + 1),
          0.4 * std::sin(0.9 * t) * std::sin(0.23 * t)};
}

struct Drive
{
  RateAt rate = streetRate;
  double late = 0;         //!< stamps of the gyroscope minus those of the scans [s]
  double scan_sigma = 0;   //!< noise of the angular velocities by the scans [rad/s]
  double gyro_sigma = 0;   //!< of the gyroscope's [rad/s]
  double gap_begin = 1e9;  //!< begin and end of a time without samples of the gyroscope [s]
  double gap_end = 1e9;
};

/** Feeds the scans from `begin` to before `end`, with the samples that are recorded by then. */
void feed(GyroscopeClock& clock, const Drive& drive, int begin, int end)
{
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  const auto noisy = [&](const Eigen::Vector3d& rate, double sigma)
  {
    return Eigen::Vector3d(rate +
                           sigma * Eigen::Vector3d(noise(random), noise(random), noise(random)));
  };
  GyroscopeClock::Rates rates;
  double next = begin * seconds_per_scan - 5;
  for (int scan = begin; scan < end; ++scan)
  {
    const double stamp = scan * seconds_per_scan;
    for (; next + drive.late <= stamp + 0.5 * seconds_per_scan; next += seconds_per_sample)
    {
      const double recorded = next + drive.late;
      if (recorded < drive.gap_begin || recorded > drive.gap_end)
      {
        rates.push_back({recorded, noisy(drive.rate(next) + Eigen::Vector3d(0.01, -0.02, 0.03),
                                         drive.gyro_sigma)});
      }
    }
    while (!rates.empty() && rates.front().stamp < stamp - 10)
    {
      rates.pop_front();
    }
    clock.compare(rates, longest_gap);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    constexpr int steps = 20;
    for (int i = 0; i < steps; ++i)
    {
      mean += drive.rate(stamp - seconds_per_scan * (i + 0.5) / steps) / steps;
    }
    clock.add(stamp - seconds_per_scan, stamp, noisy(mean, drive.scan_sigma));
  }
}

std::optional<double> offsetOf(const Drive& drive, int scans = 300)
{
  GyroscopeClock clock;
  feed(clock, drive, 1, scans);
  return clock.offset();
}

TEST(GyroscopeClock, FindsByHowMuchTheStampsAreLateOrEarly)
{
  for (const double late : {0.3, -0.3, 0.13, -0.77})
  {
    Drive drive;
    drive.late = late;
    const auto offset = offsetOf(drive);
    ASSERT_TRUE(offset) << late;
    EXPECT_NEAR(*offset, late, 0.01);
    drive.scan_sigma = 0.5 * radians_per_degree;
    drive.gyro_sigma = 0.5 * radians_per_degree;
    const auto with_noise = offsetOf(drive);
    ASSERT_TRUE(with_noise) << late;
    EXPECT_NEAR(*with_noise, late, 0.03);
  }
}

TEST(GyroscopeClock, ClocksThatAgreeHaveNoOffset)
{
  for (const double late : {0.0, 0.05, -0.08})
  {
    for (const double sigma : {0.0, 1.0, 10.0})
    {
      Drive drive;
      drive.late = late;
      drive.scan_sigma = drive.gyro_sigma = sigma * radians_per_degree;
      EXPECT_FALSE(offsetOf(drive)) << late << ", " << sigma;
    }
  }
}

TEST(GyroscopeClock, WithoutEnoughTurningNothingIsKnown)
{
  Drive drive;
  drive.late = 0.3;
  EXPECT_FALSE(offsetOf(drive, 60)) << "too few scans";
  drive.rate = [](double t) { return Eigen::Vector3d(0.1 * streetRate(t)); };
  EXPECT_FALSE(offsetOf(drive)) << "hardly any turn";
  drive.rate = [](double t) { return Eigen::Vector3d(0, 0, 0.3 + 0.2 * std::sin(0.1 * t)); };
  EXPECT_FALSE(offsetOf(drive)) << "a turn so steady that other offsets fit as well";
  drive.rate = [](double) { return Eigen::Vector3d::Zero(); };
  EXPECT_FALSE(offsetOf(drive)) << "at rest";
  drive.scan_sigma = drive.gyro_sigma = 5 * radians_per_degree;
  EXPECT_FALSE(offsetOf(drive)) << "noise alone";
}

/** Such as a body that swings: each period fits. */
TEST(GyroscopeClock, APeriodicMotionDoesNotTell)
{
  Drive drive;
  drive.late = 0.3;
  drive.rate = [](double t) { return Eigen::Vector3d(0, 0, 0.5 * std::sin(2 * M_PI * t / 0.5)); };
  EXPECT_FALSE(offsetOf(drive));
}

TEST(GyroscopeClock, GapsAreLeftOut)
{
  Drive drive;
  drive.late = 0.3;
  drive.gap_begin = 8;
  drive.gap_end = 14;
  const auto offset = offsetOf(drive);
  ASSERT_TRUE(offset);
  EXPECT_NEAR(*offset, 0.3, 0.01);
  drive.gap_begin = -1e9;
  drive.gap_end = 1e9;
  EXPECT_FALSE(offsetOf(drive)) << "no samples at all";
}

TEST(GyroscopeClock, StateIsKept)
{
  Drive drive;
  drive.late = -0.2;
  GyroscopeClock clock;
  feed(clock, drive, 1, 150);
  StateArchive saved;
  clock.exchangeState(saved);
  GyroscopeClock restored;
  StateArchive loaded(saved.bytes());
  restored.exchangeState(loaded);
  loaded.requireEnd();
  feed(clock, drive, 150, 300);
  feed(restored, drive, 150, 300);
  ASSERT_TRUE(clock.offset() && restored.offset());
  EXPECT_EQ(*clock.offset(), *restored.offset());
}
}  // namespace
}  // namespace dyslam
