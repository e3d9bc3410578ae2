// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/dyseg/TemporalFilter.h>
#include <gtest/gtest.h>

#include <limits>

namespace
{
using dyslam::Frame;
using dyslam::poseFromYpr;
using dyslam::TemporalFilter;
using dyslam::TemporalFilterOptions;

struct Rig
{
  TemporalFilter filter{TemporalFilterOptions()};

  /** A scan from x = ego along a road, with one pole at `pole` in the world. */
  float see(float ego, float pole, float probability)
  {
    Frame frame;
    frame.T_odom_vehicle = poseFromYpr(ego, 0, 0, 0, 0, 0);
    frame.cloud.points = {{pole - ego, 5, -1.7F}, {pole - ego, 5, 0.1F}};
    frame.moving_probability = {0, probability};
    filter.apply(frame);
    return frame.moving_probability[1];
  }
};

TEST(TemporalFilter, WhatWasStaticDoesNotMoveAtOnce)
{
  Rig rig;
  for (int k = 0; k < 5; ++k)
  {
    rig.see(static_cast<float>(k), 12.1F, 0.1F);
  }
  EXPECT_LT(rig.see(5, 12.1F, 0.7F), 0.5F);
}

TEST(TemporalFilter, AMoverOnFreeGroundIsFoundAtOnce)
{
  Rig rig;
  for (int k = 0; k < 5; ++k)
  {
    rig.see(static_cast<float>(k), 12.1F, 0.1F);
  }
  EXPECT_FLOAT_EQ(rig.see(5, 20.1F, 0.7F), 0.7F);
}

TEST(TemporalFilter, CreepingCountsSooner)
{
  Rig rig;
  for (int k = 0; k < 4; ++k)
  {
    rig.see(0, 12.1F, 0.6F);
  }
  EXPECT_GT(rig.see(0, 12.1F, 0.45F), 0.5F);
}

TEST(TemporalFilter, FollowsThePoseNotTheVehicle)
{
  // Seen from ever farther ahead, each time 8 m before the vehicle: another place each time.
  Rig rig;
  for (int k = 0; k < 5; ++k)
  {
    rig.see(2.0F * static_cast<float>(k), 8.1F + 2.0F * static_cast<float>(k), 0.1F);
  }
  EXPECT_FLOAT_EQ(rig.see(10, 18.1F, 0.7F), 0.7F);
}

TEST(TemporalFilter, EmptyAndInvalidPoints)
{
  Rig rig;
  Frame frame;
  rig.filter.apply(frame);
  EXPECT_TRUE(frame.moving_probability.empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.cloud.points = {{nan, nan, nan}, {1, 2, 3}};
  rig.filter.apply(frame);
  EXPECT_TRUE(frame.moving_probability.empty()) << "nothing was segmented";
  const std::vector<float> given{0.2F, 0.3F};
  frame.moving_probability = given;
  rig.filter.apply(frame);
  EXPECT_EQ(frame.moving_probability, given);
}

}  // namespace
