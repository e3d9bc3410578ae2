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

/** Says what it is told to. */
class Scripted : public dyslam::MovingSegmenter
{
 public:
  [[nodiscard]] std::string name() const override { return "scripted"; }
  [[nodiscard]] bool needsPose() const override { return false; }
  void segment(Frame& frame) override { frame.moving_probability = answer; }
  [[nodiscard]] const dyslam::MotionEstimate* staticMotion() const override { return &motion; }
  void reset() override {}

  std::vector<float> answer;
  dyslam::MotionEstimate motion;
};

struct Rig
{
  Scripted* inner = nullptr;
  std::unique_ptr<TemporalFilter> filter;

  Rig()
  {
    auto scripted = std::make_unique<Scripted>();
    inner = scripted.get();
    filter = std::make_unique<TemporalFilter>(TemporalFilterOptions(), std::move(scripted));
  }

  /** A scan from x = ego along a road, with one pole at `pole` in the world. */
  float see(float ego, float pole, float answer) const
  {
    Frame frame;
    frame.T_odom_vehicle = poseFromYpr(ego, 0, 0, 0, 0, 0);
    frame.cloud.points = {{pole - ego, 5, -1.7F}, {pole - ego, 5, 0.1F}};
    inner->answer = {0, answer};
    filter->segment(frame);
    return frame.moving_probability[1];
  }
};

TEST(TemporalFilter, WhatStoodIsNotBelievedToMoveAtOnce)
{
  const Rig rig;
  for (int k = 0; k < 5; ++k)
  {
    rig.see(static_cast<float>(k), 12.1F, 0.1F);
  }
  EXPECT_LT(rig.see(5, 12.1F, 0.7F), 0.5F);
}

TEST(TemporalFilter, AMoverOnFreeGroundIsFoundAtOnce)
{
  const Rig rig;
  for (int k = 0; k < 5; ++k)
  {
    rig.see(static_cast<float>(k), 12.1F, 0.1F);
  }
  EXPECT_FLOAT_EQ(rig.see(5, 20.1F, 0.7F), 0.7F);
}

TEST(TemporalFilter, CreepingIsBelievedSooner)
{
  const Rig rig;
  for (int k = 0; k < 4; ++k)
  {
    rig.see(0, 12.1F, 0.6F);
  }
  EXPECT_GT(rig.see(0, 12.1F, 0.45F), 0.5F);
}

TEST(TemporalFilter, FollowsThePoseNotTheVehicle)
{
  // Seen from ever farther ahead, each time 8 m before the vehicle: another place each time.
  const Rig rig;
  for (int k = 0; k < 5; ++k)
  {
    rig.see(2.0F * static_cast<float>(k), 8.1F + 2.0F * static_cast<float>(k), 0.1F);
  }
  EXPECT_FLOAT_EQ(rig.see(10, 18.1F, 0.7F), 0.7F);
}

TEST(TemporalFilter, HandsOnNoMotion)
{
  // Behind the odometry, the motion would be that of the scan before.
  const Rig rig;
  rig.see(0, 12.1F, 0.1F);
  EXPECT_EQ(rig.filter->staticMotion(), nullptr);
}

TEST(TemporalFilter, EmptyAndInvalidPoints)
{
  const Rig rig;
  Frame frame;
  rig.inner->answer = {};
  rig.filter->segment(frame);
  EXPECT_TRUE(frame.moving_probability.empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.cloud.points = {{nan, nan, nan}, {1, 2, 3}};
  rig.inner->answer = {0.2F, 0.3F};
  rig.filter->segment(frame);
  EXPECT_EQ(frame.moving_probability, rig.inner->answer);
  rig.filter->reset();
}
}  // namespace
