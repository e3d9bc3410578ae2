// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/eval/LearningCurves.h>
#include <dyslam/eval/LinePlot.h>
#include <dyslam/eval/MaskPicture.h>
#include <dyslam/eval/PaperFigures.h>
#include <dyslam/eval/TrajectoryPlot.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

namespace dyslam
{
namespace
{
PosePairs circle(double drift)
{
  PosePairs pairs;
  for (int i = 0; i < 300; ++i)
  {
    const double a = 0.02 * i;
    pairs.stamps.push_back(i);
    pairs.reference.push_back(poseFromYpr(100 * std::sin(a), 100 * (1 - std::cos(a)), 0, a, 0, 0));
    pairs.estimate.push_back(
        poseFromYpr((100 + drift * i) * std::sin(a), 100 * (1 - std::cos(a)), 0.1, a, 0, 0));
  }
  pairs.reference_size = pairs.estimate_size = pairs.stamps.size();
  return pairs;
}

TEST(Table, AlignsColumnsAndOmitsEmptyOnes)
{
  Table table({"name", "value", "none"});
  table.addRow({"a", TableCell(1.5, 2), "-"});
  table.addRow({"longer", TableCell(std::nullopt, 2), TableCell(std::nan(""), 1)});
  EXPECT_EQ(table.toText(), "name    value\n-------------\na        1.50\nlonger      -\n");
  EXPECT_EQ(table.toCsv(), "name,value,none\na,1.5,\nlonger,,\n");
  EXPECT_THROW(table.addRow({"too short"}), std::invalid_argument);
}

TEST(Table, WritesMarkdownWithoutEmptyColumns)
{
  Table table({"name", "value", "none"});
  table.addRow({"a", TableCell(1.5, 2), "-"});
  EXPECT_EQ(table.toMarkdown(), "| name | value |\n|---|---|\n| a | 1.50 |\n");
}

TEST(PaperFigures, MeansAreThoseOfTheRowsOfTable1)
{
  const auto dylo = paperMeanDrift("DyLO");
  ASSERT_TRUE(dylo && dylo->t_rel_percent && dylo->r_rel_deg_per_100m);
  EXPECT_NEAR(*dylo->t_rel_percent, 1.27, 0.005);
  EXPECT_NEAR(*dylo->r_rel_deg_per_100m, 0.665, 0.001);
  EXPECT_FALSE(paperMeanDrift("DyLO w/o mask"));
  EXPECT_FALSE(paperMeanDrift("unknown"));
}

TEST(Table, QuotesCsvAndAddsThePapersValue)
{
  Table table({"name", "t_rel"});
  table.addRow({"a,\"b\"", TableCell(0.4512345678, 2, 0.51)});
  EXPECT_EQ(table.toCsv(), "name,t_rel\n\"a,\"\"b\"\"\",0.451234568\n");
  EXPECT_NE(table.toText().find("0.45 (paper 0.51)"), std::string::npos);
  EXPECT_EQ(Table({"a", "b"}).toText(), "a  b\n----\n");
}

TEST(TrajectoryReports, TableContainsThePapersRows)
{
  const auto report = evaluateTrajectory("run", circle(0.01));
  const auto text = trajectoryTable({report}, "odometry/04").toText();
  EXPECT_NE(text.find("paper: DyLO "), std::string::npos) << text;
  EXPECT_NE(text.find("2.06"), std::string::npos) << text;
  EXPECT_NE(trajectoryTable({report}, "tracking/15").toText().find("0.366"), std::string::npos);
  EXPECT_NE(trajectoryTable({report}, "campus/02").toText().find("0.144"), std::string::npos);
  try
  {
    (void)trajectoryTable({report}, "odometry/4");
    FAIL() << "an unknown sequence was accepted";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("odometry/04"), std::string::npos) << error.what();
  }
}

TEST(TrajectoryReports, JsonHasNullForMissingValues)
{
  TrajectoryMetricsOptions options;
  options.lengths = {10000};
  const auto json = trajectoryJson({evaluateTrajectory("a \"b\"", circle(0.01), options)});
  EXPECT_NE(json.find("\"t_rel_percent\": null"), std::string::npos) << json;
  EXPECT_NE(json.find("\"a \\\"b\\\"\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"alignment\": \"se3\""), std::string::npos);
  EXPECT_EQ(trajectoryJson({}), "{\n  \"trajectories\": []\n}\n");
}

TEST(TrajectoryReports, DriftAndStatisticsTables)
{
  const std::vector<TrajectoryReport> reports{evaluateTrajectory("a", circle(0.01)),
                                              evaluateTrajectory("b", circle(0.02))};
  EXPECT_EQ(driftTable(reports).rows(), 8U);
  EXPECT_EQ(errorStatisticsTable(reports).rows(), 8U);
  EXPECT_EQ(driftTable({}).rows(), 0U);
}

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
}  // namespace

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

TEST(LearningCurves, ReadsColumnsAndSeries)
{
  const auto log = parseLearningLog(
      "step,set,start,error_m,loss\n10,first,standing,0.5,2\n10,second,standing,0.7,nan\n"
      "20,first,standing,0.25,1\n",
      "v.csv");
  ASSERT_EQ(log.columns.size(), 2U);
  EXPECT_EQ(log.columns[0].name, "error_m");
  EXPECT_EQ(log.step, (std::vector<double>{10, 10, 20}));
  EXPECT_EQ(log.series[1], "second, standing");
  EXPECT_DOUBLE_EQ(log.columns[0].value[2], 0.25);
  EXPECT_TRUE(std::isnan(log.columns[1].value[1]));
  const auto picture = renderLearningCurves(log);
  ASSERT_GT(picture.size(), 8U);
  EXPECT_EQ(std::string(picture.begin() + 1, picture.begin() + 4), "PNG");
  EXPECT_EQ(picture, renderLearningCurves(log));
}

TEST(LearningCurves, RejectsOtherFiles)
{
  const auto refused = [](const char* text, const char* part)
  {
    try
    {
      (void)parseLearningLog(text, "l.csv");
      ADD_FAILURE() << text;
    }
    catch (const UserError& error)
    {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("", "must be `step`");
  refused("20,0.5,1\n40,0.4,1\n", "must be `step`");
  refused("x,y,z\n1,2,3\n", "must be `step`");
  refused("step,loss\n", "no rows");
  refused("step,loss\n1,2\n2,3,4\n", "row 2 has 3 fields");
  EXPECT_THROW((void)renderLearningCurves(LearningLog()), std::invalid_argument);
}

TEST(MaskPicture, RocCurveMatchesAHandComputedOne)
{
  // Two of three moving points are less static than any static one; ties form one step.
  const auto scan = parseMaskScan(
      "x,y,z,static_confidence,label\n1,2,0,0.1,2\n3,4,0,0.2,2\n5,6,0,0.9,2\n7,8,0,0.9,1\n"
      "9,1,0,0.95,1\r\n9,2,0,-1,1\n9,3,0,0.5,0\n",
      "m.csv");
  ASSERT_EQ(scan.points.size(), 7U);
  const auto roc = rocCurve(scan);
  ASSERT_EQ(roc.size(), 5U);
  EXPECT_EQ(roc[2], Eigen::Vector2d(0, 2.0 / 3));
  EXPECT_EQ(roc[3], Eigen::Vector2d(0.5, 1));
  EXPECT_EQ(roc[4], Eigen::Vector2d(1, 1));
  EXPECT_NEAR(areaUnderCurve(scan), (2 + 2 + 0.5 + 1) / 6.0, 1e-12);
  const auto picture = renderMaskScan(scan);
  const cv::Mat image = cv::imdecode(picture, cv::IMREAD_COLOR);
  EXPECT_GT(image.cols, image.rows) << "the view and the curve";
}

TEST(MaskPicture, NoRocCurveWithoutMovingPoints)
{
  const auto scan = parseMaskScan("x,y,z,static_confidence,label\n1,2,0,0.1,1\n", "m.csv");
  EXPECT_TRUE(rocCurve(scan).empty());
  EXPECT_TRUE(std::isnan(areaUnderCurve(scan)));
  const cv::Mat image = cv::imdecode(renderMaskScan(scan), cv::IMREAD_COLOR);
  EXPECT_EQ(image.cols, image.rows);
}

TEST(MaskPicture, RefusesOtherFiles)
{
  const std::string header = "x,y,z,static_confidence,label\n";
  EXPECT_THROW((void)parseMaskScan("step,loss\n1,2\n", "m.csv"), UserError);
  for (const char* rows : {"", "1,2,3,4\n", "1,2,3,0.4,a\n", "1,2,3,5,1\n", "1,2,3,nan,1\n",
                           "1,2,3,0.5,7\n", "1,2,3,0.5,1,9\n"})
  {
    EXPECT_THROW((void)parseMaskScan(header + rows, "m.csv"), UserError) << rows;
  }
}
}  // namespace dyslam
