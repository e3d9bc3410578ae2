// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/plot/LinePlot.h>
#include <dyslam/plot/MaskPicture.h>
#include <dyslam/plot/TrajectoryPlot.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "CirclePairs.h"

namespace dyslam
{
namespace
{
TEST(TrajectoryPlot, IsAPngContainingTheCurvesColour)
{
  const std::vector<TrajectoryPlotItem> items{{"first", circle(0.05)}};
  const auto bytes = renderTrajectoryPlot(items);
  EXPECT_EQ(bytes, renderTrajectoryPlot(items));
  const cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ASSERT_EQ(picture.cols, 1600);
  ASSERT_GE(picture.rows, 800);
  std::size_t blue = 0;
  for (int y = 70; y < 730; ++y)
  {
    for (int x = 100; x < 790; ++x)
    {
      const auto& c = picture.at<cv::Vec3b>(y, x);
      blue += c[0] > 150 && c[2] < 60 ? 1 : 0;
    }
  }
  EXPECT_GT(blue, 500U);
}

TEST(TrajectoryPlot, PathsNeedNoReference)
{
  std::vector<Pose> poses = circle(0).reference;
  poses[3].translation().x() = std::numeric_limits<double>::quiet_NaN();
  const auto bytes = renderPaths({{"a", poses}, {"b", circle(0.05).estimate}});
  EXPECT_EQ(bytes, renderPaths({{"a", poses}, {"b", circle(0.05).estimate}}));
  EXPECT_NE(bytes, renderPaths({{"a", poses}}));
  EXPECT_EQ(1600, cv::imdecode(bytes, cv::IMREAD_COLOR).cols);
  EXPECT_FALSE(renderPaths({{"still", {Pose::Identity()}}}).empty());
  EXPECT_THROW((void)renderPaths({}), std::invalid_argument);
  EXPECT_THROW((void)renderPaths({{"empty", {}}}), std::invalid_argument);
}

TEST(TrajectoryPlot, HandlesOnePoseStationaryAndEmptyInput)
{
  PosePairs one;
  one.stamps = {0};
  one.reference = {Pose::Identity()};
  one.estimate = {Pose::Identity()};
  EXPECT_FALSE(renderTrajectoryPlot({{"one", one}}).empty());
  PosePairs still = one;
  still.stamps = {0, 1};
  still.reference.push_back(Pose::Identity());
  still.estimate.push_back(Pose::Identity());
  EXPECT_FALSE(renderTrajectoryPlot({{"still", still}}).empty());
  EXPECT_THROW((void)renderTrajectoryPlot({}), std::invalid_argument);
  EXPECT_THROW((void)renderTrajectoryPlot({{"empty", PosePairs()}}), std::invalid_argument);
}

TEST(TrajectoryPlot, PositionsAloneHaveNoErrorsOfSteps)
{
  PosePairs positions = circle(0.05);
  const auto whole = renderTrajectoryPlot({{"a", positions}});
  positions.positions_only = true;
  const auto without = renderTrajectoryPlot({{"a", positions}});
  EXPECT_FALSE(without.empty());
  EXPECT_NE(without, whole);
}

TEST(TrajectoryPlot, DifferencesToAnInexactReferenceAreNotTitledErrors)
{
  const std::vector<TrajectoryPlotItem> items{{"a", circle(0.05)}};
  const cv::Mat errors = cv::imdecode(renderTrajectoryPlot(items), cv::IMREAD_COLOR);
  const cv::Mat differences =
      cv::imdecode(renderTrajectoryPlot(items, {"", Alignment::se3, "GNSS/INS"}), cv::IMREAD_COLOR);
  ASSERT_EQ(errors.size(), differences.size());
  const auto differ = [&](const cv::Rect& area)
  { return cv::norm(errors(area), differences(area), cv::NORM_INF) > 0; };
  EXPECT_TRUE(differ({900, 40, 660, 28})) << "title of the positions";
  EXPECT_TRUE(differ({900, 430, 660, 28})) << "title of the steps";
  EXPECT_TRUE(differ({100, 800, 690, errors.rows - 800})) << "legend";
  EXPECT_FALSE(differ({100, 70, 690, 660})) << "the paths";
  EXPECT_FALSE(differ({901, 71, 658, 268})) << "the curve";
}

TEST(TrajectoryPlot, TheReferenceIsThatOfTheLongestEstimate)
{
  const PosePairs whole = circle(0.05);
  PosePairs part = whole;
  part.stamps.resize(whole.size() / 8);
  part.reference.resize(whole.size() / 8);
  part.estimate.resize(whole.size() / 8);
  const auto greyPixels = [](const std::vector<TrajectoryPlotItem>& items)
  {
    const cv::Mat picture = cv::imdecode(renderTrajectoryPlot(items), cv::IMREAD_COLOR);
    cv::Mat grey;
    cv::inRange(picture(cv::Rect(100, 70, 690, 660)), cv::Scalar::all(180), cv::Scalar::all(190),
                grey);
    return cv::countNonZero(grey);
  };
  const int of_whole = greyPixels({{"whole", whole}, {"whole", whole}});
  EXPECT_GT(of_whole, 1000);
  EXPECT_GT(greyPixels({{"part", part}, {"whole", whole}}), of_whole / 2);
}

TEST(LinePlot, DrawsEverySeriesInItsColourWithinTheAxes)
{
  LineSeries rising{"rising", {}};
  LineSeries peak{"with a peak", {}};
  for (int i = 0; i <= 200; ++i)
  {
    rising.points.emplace_back(0.1 * i, 0.05 * i);
    peak.points.emplace_back(0.1 * i, i == 100 ? 1000 : 5);
  }
  LinePlotOptions options;
  options.quantile = 0.99;
  const auto bytes = renderLinePlot({rising, peak}, options);
  EXPECT_EQ(bytes, renderLinePlot({rising, peak}, options));
  const cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ASSERT_EQ(picture.cols, 1000);
  // Within the axes: the blue line rises through the page, as the peak does not set the scale.
  int highest = picture.rows;
  std::size_t red = 0;
  for (int y = 52; y < 318; ++y)
  {
    for (int x = 95; x < 965; ++x)
    {
      const auto& c = picture.at<cv::Vec3b>(y, x);
      highest = c[0] > 150 && c[2] < 60 ? std::min(highest, y) : highest;
      red += c[2] > 180 && c[0] < 60 ? 1 : 0;
    }
  }
  EXPECT_LT(highest, 110);
  EXPECT_GT(red, 500U);
  EXPECT_FALSE(renderLinePlot({{"one", {{1, 2}}}}).empty());
  EXPECT_THROW((void)renderLinePlot({{"none", {}}}), std::invalid_argument);
}

TEST(MaskPicture, ShowsTheViewAndTheCurveIfThereIsOne)
{
  const std::string header = "x,y,z,static_confidence,label\n";
  const auto both = parseMaskScan(header + "1,2,0,0.1,2\n3,4,0,0.9,1\n", "m.csv");
  const cv::Mat with_curve = cv::imdecode(renderMaskScan(both), cv::IMREAD_COLOR);
  EXPECT_GT(with_curve.cols, with_curve.rows) << "the view and the curve";
  const auto still = parseMaskScan(header + "1,2,0,0.1,1\n", "m.csv");
  const cv::Mat view = cv::imdecode(renderMaskScan(still), cv::IMREAD_COLOR);
  EXPECT_EQ(view.cols, view.rows);
}
}  // namespace
}  // namespace dyslam
