// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Calibration.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace dyslam
{
namespace
{
constexpr std::uint32_t moving = 252;
constexpr std::uint32_t still = 40;

TEST(Calibration, ProbabilitiesThatAreWhatTheySayHaveNoError)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  CalibrationEvaluator right;
  CalibrationEvaluator overconfident;
  for (int scan = 0; scan < 20; ++scan)
  {
    std::vector<std::uint32_t> labels;
    std::vector<float> stated;
    std::vector<float> exaggerated;
    for (int i = 0; i < 10000; ++i)
    {
      const float p = uniform(random);
      labels.push_back(uniform(random) < p ? moving : still);
      stated.push_back(p);
      exaggerated.push_back(p > 0.5F ? 1.0F : 0.0F);
    }
    right.add(labels, stated);
    overconfident.add(labels, exaggerated);
  }
  EXPECT_EQ(right.points(), 200000U);
  EXPECT_LT(right.expectedError(), 0.01);
  EXPECT_NEAR(right.brierScore(), 1.0 / 6, 0.01);  // mean of p (1 - p)
  EXPECT_NEAR(overconfident.expectedError(), 0.25, 0.01);
  EXPECT_NEAR(overconfident.brierScore(), 0.25, 0.01);
}

TEST(Calibration, BinsHoldTheirPoints)
{
  CalibrationEvaluator evaluator;
  evaluator.add({moving, still, still, moving, still}, {0.31F, 0.35F, 0.39F, 1.0F, 0.0F});
  const auto bins = evaluator.bins();
  ASSERT_EQ(bins.size(), 10U);
  EXPECT_EQ(bins[3].points, 3U);
  EXPECT_NEAR(bins[3].probability, 0.35, 1e-6);
  EXPECT_NEAR(bins[3].moving, 1.0 / 3, 1e-12);
  EXPECT_EQ(bins[9].points, 1U);
  EXPECT_EQ(bins[0].points, 1U);
  EXPECT_EQ(bins[5].points, 0U);
}

TEST(Calibration, UnlabelledPointsAndThoseWithoutProbabilityAreLeftOut)
{
  CalibrationEvaluator evaluator;
  evaluator.add({0, 1, moving, moving},
                {0.5F, 0.5F, std::numeric_limits<float>::quiet_NaN(), 0.75F});
  EXPECT_EQ(evaluator.points(), 1U);
  EXPECT_NEAR(evaluator.brierScore(), 0.0625, 1e-9);
  EXPECT_THROW(evaluator.add({moving}, {}), std::invalid_argument);
}

TEST(Calibration, NothingHasNoError)
{
  EXPECT_EQ(CalibrationEvaluator().expectedError(), 0);
  EXPECT_EQ(CalibrationEvaluator().brierScore(), 0);
}
}  // namespace
}  // namespace dyslam
