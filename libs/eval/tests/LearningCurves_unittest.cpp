// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/eval/LearningCurves.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace dyslam
{
namespace
{
/** Pixels of a curve: axes and text are grey. */
int colouredPixels(const std::vector<std::uint8_t>& png)
{
  const cv::Mat image = cv::imdecode(png, cv::IMREAD_COLOR);
  int count = 0;
  for (int i = 0; i < image.rows * image.cols; ++i)
  {
    const auto& pixel = image.at<cv::Vec3b>(i / image.cols, i % image.cols);
    const auto [least, most] = std::minmax({pixel[0], pixel[1], pixel[2]});
    count += most - least > 60 ? 1 : 0;
  }
  return count;
}

TEST(LearningCurves, StepsAndValuesOfAnySizeAreDrawn)
{
  for (const std::string rows : {"1,0.5\n2,0.4\n", "1e16,1\n10000000000000002,2\n",
                                 "-1e100,1e100\n1e100,-1e100\n", "0,1e-320\n1,2e-320\n"})
  {
    const auto log = parseLearningLog("step,loss\n" + rows, "a.csv");
    EXPECT_GT(colouredPixels(renderLearningCurves(log)), 10) << rows;
  }
}

TEST(LearningCurves, WhatCannotBeDrawnIsLeftOut)
{
  for (const std::string rows : {"nan,1\n", "inf,1\n3,nan\n", "-1e308,1e308\n1e308,-1e308\n"})
  {
    const auto log = parseLearningLog("step,loss\n" + rows, "a.csv");
    EXPECT_EQ(colouredPixels(renderLearningCurves(log)), 0) << rows;
  }
}

TEST(LearningCurves, CellsWithoutANumberAreNaN)
{
  const auto log = parseLearningLog("step,loss,score\r\n1,0.5,\r\n\r\n2,,0.7\r\n", "a.csv");
  ASSERT_EQ(log.columns.size(), 2U);
  EXPECT_EQ(log.step, (std::vector<double>{1, 2}));
  EXPECT_EQ(log.columns[0].value[0], 0.5);
  EXPECT_TRUE(std::isnan(log.columns[0].value[1]));
  EXPECT_TRUE(std::isnan(log.columns[1].value[0]));
  EXPECT_EQ(log.columns[1].value[1], 0.7);
}

TEST(LearningCurves, DamagedLogsAreRefused)
{
  for (const std::string text : {"loss,step\n1,2\n", "step,loss\n1\n", "step,loss\n", ""})
  {
    EXPECT_THROW((void)parseLearningLog(text, "a.csv"), UserError) << text;
  }
}
}  // namespace
}  // namespace dyslam
