// SPDX-License-Identifier: BSD-3-Clause
// What dyslam-train writes: logs, and scans with the mask of DyLO.
#include <dyslam/base/Error.h>
#include <dyslam/eval/LearningLog.h>
#include <dyslam/eval/MaskScan.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace dyslam
{
namespace
{
TEST(LearningLog, ReadsColumnsAndSeries)
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
}

TEST(LearningLog, RecordingsMayHaveNumbersAsNames)
{
  const auto log = parseLearningLog(
      "step,recording,start,t_mean_m\n10,08,standing,0.5\n10,09,standing,0.7\n", "v.csv");
  ASSERT_EQ(log.columns.size(), 1U);
  EXPECT_EQ(log.columns[0].name, "t_mean_m");
  EXPECT_EQ(log.series, (std::vector<std::string>{"08, standing", "09, standing"}));
}

TEST(LearningLog, RejectsOtherFiles)
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
}

TEST(LearningLog, CellsWithoutANumberAreNaN)
{
  const auto log = parseLearningLog("step,loss,score\r\n1,0.5,\r\n\r\n2,,0.7\r\n", "a.csv");
  ASSERT_EQ(log.columns.size(), 2U);
  EXPECT_EQ(log.step, (std::vector<double>{1, 2}));
  EXPECT_EQ(log.columns[0].value[0], 0.5);
  EXPECT_TRUE(std::isnan(log.columns[0].value[1]));
  EXPECT_TRUE(std::isnan(log.columns[1].value[0]));
  EXPECT_EQ(log.columns[1].value[1], 0.7);
}

TEST(LearningLog, ColumnsWithoutAnyEntryAreLeftOut)
{
  const auto log = parseLearningLog(
      "step,set,iou,precision\n1,street,0,\n1,highway,0,\n2,street,0,\n", "validation.csv");
  ASSERT_EQ(log.columns.size(), 1U);
  EXPECT_EQ(log.columns[0].name, "iou");
  EXPECT_EQ(log.series, (std::vector<std::string>{"street", "highway", "street"}));
}

TEST(LearningLog, DamagedLogsAreRefused)
{
  for (const std::string text : {"loss,step\n1,2\n", "step,loss\n1\n", "step,loss\n", ""})
  {
    EXPECT_THROW((void)parseLearningLog(text, "a.csv"), UserError) << text;
  }
}

TEST(MaskScan, RocCurveMatchesAHandComputedOne)
{
  // Two of three moving points are less static than any static one; ties form one step.
  const auto scan = parseMaskScan(
      "x,y,z,static_confidence,label\n1,2,0,0.1,2\n3,4,0,0.2,2\n5,6,0,0.9,2\n7,8,0,0.9,1\n"
      "9,1,0,0.95,1\r\n9,2,0,-1,1\n9,3,0,0.5,0\n",
      "m.csv");
  ASSERT_EQ(scan.points.size(), 7U);
  EXPECT_EQ(sampledPoints(scan, MaskScan::Truth::moving), 3U);
  EXPECT_EQ(sampledPoints(scan, MaskScan::Truth::stationary), 2U);
  const auto roc = rocCurve(scan);
  ASSERT_EQ(roc.size(), 5U);
  EXPECT_EQ(roc[2], Eigen::Vector2d(0, 2.0 / 3));
  EXPECT_EQ(roc[3], Eigen::Vector2d(0.5, 1));
  EXPECT_EQ(roc[4], Eigen::Vector2d(1, 1));
  EXPECT_NEAR(areaUnderCurve(scan), (2 + 2 + 0.5 + 1) / 6.0, 1e-12);
}

TEST(MaskScan, NoRocCurveWithoutMovingPoints)
{
  const auto scan = parseMaskScan("x,y,z,static_confidence,label\n1,2,0,0.1,1\n", "m.csv");
  EXPECT_TRUE(rocCurve(scan).empty());
  EXPECT_TRUE(std::isnan(areaUnderCurve(scan)));
}

TEST(MaskScan, RefusesOtherFiles)
{
  const std::string header = "x,y,z,static_confidence,label\n";
  EXPECT_THROW((void)parseMaskScan("step,loss\n1,2\n", "m.csv"), UserError);
  for (const char* rows : {"", "1,2,3,4\n", "1,2,3,0.4,a\n", "1,2,3,5,1\n", "1,2,3,nan,1\n",
                           "1,2,3,0.5,7\n", "1,2,3,0.5,1,9\n"})
  {
    EXPECT_THROW((void)parseMaskScan(header + rows, "m.csv"), UserError) << rows;
  }
}
}  // namespace
}  // namespace dyslam
