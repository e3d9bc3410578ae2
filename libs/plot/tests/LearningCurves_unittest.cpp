// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/plot/LearningCurves.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "PlotPage.h"

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

TEST(LearningCurves, ColoursOfManySeriesDiffer)
{
  std::set<std::array<double, 3>> colours;
  for (std::size_t i = 0; i < 21; ++i)
  {
    const cv::Scalar colour = plot::curveColour(i);
    colours.insert({colour[0], colour[1], colour[2]});
  }
  EXPECT_EQ(colours.size(), 21U);
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

TEST(LearningCurves, SeriesAreDrawnToAPng)
{
  const auto log = parseLearningLog(
      "step,set,start,error_m,loss\n10,first,standing,0.5,2\n10,second,standing,0.7,nan\n"
      "20,first,standing,0.25,1\n",
      "v.csv");
  const auto picture = renderLearningCurves(log);
  ASSERT_GT(picture.size(), 8U);
  EXPECT_EQ(std::string(picture.begin() + 1, picture.begin() + 4), "PNG");
  EXPECT_EQ(picture, renderLearningCurves(log));
  EXPECT_THROW((void)renderLearningCurves(LearningLog()), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam
