// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Labels.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Trajectory.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace dyslam
{
namespace
{
Trajectory straight()
{
  Trajectory t;
  t.push_back(10, poseFromYpr(0, 0, 0, 0, 0, 0));
  t.push_back(11, poseFromYpr(2, 0, 0, 0, 0, 0));
  t.push_back(13, poseFromYpr(2, 3, 0, 0, 0, 0));
  return t;
}

TEST(Trajectory, InterpolatesInsideOnly)
{
  const auto t = straight();
  EXPECT_FALSE(t.at(9.9));
  EXPECT_FALSE(t.at(13.1));
  EXPECT_NEAR(t.at(10.5)->translation().x(), 1, 1e-12);
  EXPECT_NEAR(t.at(12)->translation().y(), 1.5, 1e-12);
  EXPECT_NEAR(t.at(13)->translation().y(), 3, 1e-12);
}

TEST(Trajectory, InterpolatesOverShortGapsOnly)
{
  const auto t = straight();
  EXPECT_NEAR(t.at(10.5, 0.6)->translation().x(), 1, 1e-12);
  EXPECT_FALSE(t.at(10.1, 0.6));  // the pose after is 0.9 s away
  EXPECT_FALSE(t.at(11.1, 0.6));
  EXPECT_NEAR(t.at(11, 0.1)->translation().x(), 2, 1e-12);
  EXPECT_FALSE(t.at(9.9, 5));
  EXPECT_FALSE(t.at(13.1, 5));
  EXPECT_FALSE(Trajectory().at(1, 5));
}

TEST(Trajectory, NearestWithinTolerance)
{
  const auto t = straight();
  EXPECT_EQ(t.nearest(10.4, 0.5), 0U);
  EXPECT_EQ(t.nearest(10.6, 0.5), 1U);
  EXPECT_EQ(t.nearest(12.1, 2), 2U);
  EXPECT_FALSE(t.nearest(20, 1));
  EXPECT_FALSE(t.nearest(0, 1));
  EXPECT_FALSE(Trajectory().nearest(0, 1));
}

TEST(Trajectory, PathLengthsAddUp)
{
  EXPECT_EQ(straight().pathLengths(), (std::vector<double>{0, 2, 5}));
  EXPECT_TRUE(Trajectory().pathLengths().empty());
}

/** An hour at 10 Hz between two drives. */
TEST(Trajectory, StandingStillIsNoPath)
{
  std::mt19937 rng(1);
  std::normal_distribution<double> jitter(0, 0.0007);
  Trajectory t;
  double stamp = 0;
  const auto stand = [&](double x)
  { t.push_back(stamp += 0.1, poseFromYpr(x + jitter(rng), jitter(rng), jitter(rng), 0, 0, 0)); };
  stand(0);
  for (int i = 0; i < 36000; ++i)
  {
    stand(10);
  }
  for (int i = 0; i < 1000; ++i)
  {
    stand(10 + 0.01 * i);  // slower than the dead band per scan
  }
  const std::vector<double> lengths = t.pathLengths();
  EXPECT_NEAR(lengths[36000], 10, 0.01);
  EXPECT_NEAR(lengths.back(), 20, 0.15);
}

TEST(Trajectory, PositionsThatAreNotFiniteAreNoPath)
{
  Trajectory t;
  for (const double x : {std::nan(""), 1.0, std::nan(""), 3.0})
  {
    t.push_back(x, poseFromYpr(x, 0, 0, 0, 0, 0));
  }
  EXPECT_EQ(t.pathLengths(), (std::vector<double>{0, 0, 0, 2}));
}

TEST(ObjectClass, NamesRoundTrip)
{
  for (const auto c : {ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::bus,
                       ObjectClass::motorcyclist, ObjectClass::cyclist, ObjectClass::pedestrian})
  {
    EXPECT_EQ(objectClassFromString(toString(c)), c);
  }
  EXPECT_EQ(objectClassFromString("DontCare"), ObjectClass::unknown);
}

TEST(Labels, MovingAndIgnored)
{
  constexpr std::uint32_t instance = 7U << 16U;
  EXPECT_TRUE(isMovingLabel(251) && isMovingLabel(252 + instance) && isMovingLabel(259));
  EXPECT_FALSE(isMovingLabel(250) || isMovingLabel(260) || isMovingLabel(9 + instance));
  EXPECT_TRUE(isIgnoredLabel(0) && isIgnoredLabel(1 + instance));
  EXPECT_FALSE(isIgnoredLabel(2) || isIgnoredLabel(252));
}
}  // namespace
}  // namespace dyslam
