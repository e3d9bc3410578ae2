// SPDX-License-Identifier: BSD-3-Clause
#include "../src/recording/TruePoses.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
constexpr double max_gap = 0.2;

Pose poseAtX(double x)
{
  return poseFromYpr(x, 0, 0, 0, 0, 0);
}
}  // namespace

TEST(TruePoses, TheSameStampElseInterpolatedWithinTheGap)
{
  TruePoses truth(max_gap);
  EXPECT_FALSE(truth.at(10, 0)) << "none was read";
  for (const double stamp : {10.0, 10.1, 10.5, 10.6})
  {
    truth.add(stamp, poseAtX(stamp), 0);
  }
  EXPECT_EQ(truth.at(10.1, 0)->translation().x(), 10.1);
  EXPECT_FALSE(truth.at(10.2, 0)) << "the next pose is 0.3 s later";
  EXPECT_NEAR(truth.at(10.53, 0)->translation().x(), 10.53, 1e-12);
  EXPECT_FALSE(truth.at(10.7, 0)) << "no pose comes after the scan";
}

/** The scans at 20.0 s before and after the clock was set back have different poses. */
TEST(TruePoses, PosesAfterAClockWasSetBackBelongToLaterScans)
{
  TruePoses truth(max_gap);
  for (const double stamp : {20.0, 20.1, 20.2})
  {
    truth.add(stamp, poseAtX(stamp), 0);
  }
  for (const double stamp : {20.0, 20.1})  // read before the scans show it
  {
    truth.add(stamp, poseAtX(100 + stamp), 0);
  }
  constexpr double shift = 0.3;
  truth.shiftClock(0, shift);
  EXPECT_EQ(truth.at(20.0, 0)->translation().x(), 20.0);
  EXPECT_EQ(truth.at(20.0, shift)->translation().x(), 120.0);
  EXPECT_NEAR(truth.at(20.1, shift)->translation().x(), 120.1, 1e-12);
}
}  // namespace dyslam
