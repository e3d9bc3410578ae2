// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/LearningRate.h>
#include <gtest/gtest.h>

namespace
{
using dyslam::LearningRateOptions;

TEST(LearningRate, GoesUpStaysAndGoesDown)
{
  LearningRateOptions rate;
  rate.learning_rate = 0.5;
  rate.warmup_steps = 10;
  rate.decay_start = 0.6;
  rate.final_rate_ratio = 0.1;
  EXPECT_DOUBLE_EQ(rate.rateAt(0, 100), 0.05);
  EXPECT_DOUBLE_EQ(rate.rateAt(4, 100), 0.25);
  EXPECT_DOUBLE_EQ(rate.rateAt(9, 100), 0.5);
  EXPECT_DOUBLE_EQ(rate.rateAt(60, 100), 0.5);
  EXPECT_DOUBLE_EQ(rate.rateAt(80, 100), 0.5 * 0.55);
  EXPECT_DOUBLE_EQ(rate.rateAt(100, 100), 0.05);
}

TEST(LearningRate, UntilTheDecayTheNumberOfStepsDoesNotMatter)
{
  LearningRateOptions rate;
  rate.decay_start = 0.5;
  EXPECT_EQ(rate.firstOfDecay(301), 151);
  for (int step = 0; step < rate.firstOfDecay(301); ++step)
  {
    ASSERT_EQ(rate.rateAt(step, 301), rate.rateAt(step, 4000)) << step;
  }
  EXPECT_LT(rate.rateAt(200, 301), rate.rateAt(200, 4000));
  rate.decay_start = 1;
  EXPECT_EQ(rate.rateAt(299, 300), rate.learning_rate);
}
}  // namespace
