// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/eval/PaperFigures.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "CirclePairs.h"

namespace dyslam
{
namespace
{
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

TEST(TrajectoryReports, OfPositionsAloneThereIsTheAbsoluteErrorOfPositions)
{
  PosePairs pairs = circle(0.05);
  const TrajectoryReport whole = evaluateTrajectory("poses", pairs);
  pairs.positions_only = true;
  const TrajectoryReport report = evaluateTrajectory("positions", pairs);
  EXPECT_NEAR(report.absolute.translation.rmse, whole.absolute.translation.rmse, 1e-6);
  const std::string json = trajectoryJson({report});
  for (const char* null : {"\"t_rel_percent\": null", "\"rpe\": null", "\"rotation_deg\": null",
                           "\"forward_ratio\": null", "\"end_error\": null"})
  {
    EXPECT_NE(json.find(null), std::string::npos) << null << '\n' << json;
  }
  const std::string csv = trajectoryTable({report}).toCsv();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2);
  EXPECT_NE(csv.find(",,,,,"), std::string::npos) << "t_rel, r_rel, RPE: " << csv;
  EXPECT_NE(csv.find(",,,,\n"), std::string::npos) << "ATE [deg], forward, end: " << csv;
  EXPECT_EQ(errorStatisticsTable({report}).rows(), 1U);
  EXPECT_EQ(errorStatisticsTable({report, whole}).rows(), 5U);
  EXPECT_EQ(driftTable({whole, report}).rows(), 8U);
}

TEST(TrajectoryReports, DriftAndStatisticsTables)
{
  const std::vector<TrajectoryReport> reports{evaluateTrajectory("a", circle(0.01)),
                                              evaluateTrajectory("b", circle(0.02))};
  EXPECT_EQ(driftTable(reports).rows(), 8U);
  EXPECT_EQ(errorStatisticsTable(reports).rows(), 8U);
  EXPECT_EQ(driftTable({}).rows(), 0U);
  TrajectoryMetricsOptions options;
  options.lengths = {2.5};
  const std::string text = driftTable({evaluateTrajectory("a", circle(0.01), options)}).toText();
  EXPECT_NE(text.find("\n2.5 "), std::string::npos) << text;
}
}  // namespace
}  // namespace dyslam
