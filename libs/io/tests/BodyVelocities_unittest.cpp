// SPDX-License-Identifier: BSD-3-Clause
#include "../src/recording/BodyVelocities.h"

#include <gtest/gtest.h>

#include <limits>

namespace dyslam
{
namespace
{
Vector6 velocityAlong(double speed, double yaw_rate)
{
  Vector6 velocity = Vector6::Zero();
  velocity[0] = speed;
  velocity[5] = yaw_rate;
  return velocity;
}

/** On a circle of 20 m at 5 m/s. */
Pose poseOnCircle(double stamp)
{
  return expSE3(velocityAlong(5, 0.25) * stamp);
}
}  // namespace

TEST(BodyVelocities, MeasuredOnesAreTaken)
{
  BodyVelocities velocities;
  const Vector6 measured = velocityAlong(3, 0.1);
  for (const double stamp : {10.0, 10.1, 20.0})
  {
    const auto velocity = velocities.add(stamp, measured, poseOnCircle(stamp));
    ASSERT_TRUE(velocity);
    EXPECT_EQ(stamp, velocity->stamp);
    EXPECT_EQ(measured, velocity->velocity);
  }
  EXPECT_FALSE(velocities.replacesZeros());
}

TEST(BodyVelocities, PosesReplaceMissingOnes)
{
  BodyVelocities velocities;
  EXPECT_FALSE(velocities.add(10, std::nullopt, std::nullopt));
  EXPECT_FALSE(velocities.add(10, std::nullopt, poseOnCircle(10)));
  const auto velocity = velocities.add(10.5, std::nullopt, poseOnCircle(10.5));
  ASSERT_TRUE(velocity);
  EXPECT_EQ(10.25, velocity->stamp);
  EXPECT_TRUE(velocity->velocity.isApprox(velocityAlong(5, 0.25), 1e-9));
  EXPECT_FALSE(velocities.replacesZeros());  // there were none
}

TEST(BodyVelocities, PosesReplaceZerosUntilAVelocityIsMeasured)
{
  BodyVelocities velocities;
  const Vector6 zero = Vector6::Zero();
  EXPECT_FALSE(velocities.add(10, zero, poseOnCircle(10)));
  EXPECT_FALSE(velocities.replacesZeros());
  const auto moving = velocities.add(10.5, zero, poseOnCircle(10.5));
  ASSERT_TRUE(moving);
  EXPECT_TRUE(moving->velocity.isApprox(velocityAlong(5, 0.25), 1e-9));
  EXPECT_TRUE(velocities.replacesZeros());
  EXPECT_EQ(7, velocities.add(11, velocityAlong(7, 0), poseOnCircle(11))->velocity[0]);
  EXPECT_EQ(zero, velocities.add(11.5, zero, poseOnCircle(11.5))->velocity);
  EXPECT_FALSE(velocities.replacesZeros());
}

TEST(BodyVelocities, ZerosOfABodyThatStandsOrHasNoPoseAreKept)
{
  BodyVelocities velocities;
  const Vector6 zero = Vector6::Zero();
  EXPECT_EQ(zero, velocities.add(9, zero, std::nullopt)->velocity);
  (void)velocities.add(10, zero, poseOnCircle(1));
  EXPECT_NEAR(0, velocities.add(10.5, zero, poseOnCircle(1))->velocity.norm(), 1e-12);
  EXPECT_FALSE(velocities.replacesZeros());
}

TEST(BodyVelocities, PosesOutOfOrderFarApartOrNotFiniteGiveNone)
{
  BodyVelocities velocities;
  const auto isTaken = [&velocities](double stamp, const Pose& pose)
  { return velocities.add(stamp, std::nullopt, pose).has_value(); };
  EXPECT_FALSE(isTaken(10, poseOnCircle(10)));
  EXPECT_FALSE(isTaken(10, poseOnCircle(10)));
  EXPECT_FALSE(isTaken(9, poseOnCircle(9)));
  EXPECT_TRUE(isTaken(10, poseOnCircle(10)));
  EXPECT_FALSE(isTaken(11.5, poseOnCircle(11.5)));
  Pose broken = poseOnCircle(12);
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isTaken(12, broken));
  EXPECT_FALSE(isTaken(12.5, poseOnCircle(12.5)));
  EXPECT_TRUE(isTaken(13, poseOnCircle(13)));
}
}  // namespace dyslam
