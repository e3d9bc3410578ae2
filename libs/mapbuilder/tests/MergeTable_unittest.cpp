// SPDX-License-Identifier: BSD-3-Clause
#include "MergeTable.h"

#include <gtest/gtest.h>

#include <string>

#include "TestFolder.h"
#include "TestRun.h"

namespace dyslam
{
namespace
{
RunFolder runWith(const std::string& name, const Trajectory& trajectory)
{
  RunFolder run;
  run.name = name;
  run.trajectory = trajectory;
  for (const auto& [stamp, pose] : trajectory)
  {
    run.keyframe_stamps.push_back(stamp);
  }
  return run;
}

std::string firstLine(const std::string& text)
{
  return text.substr(0, text.find_first_of("\r\n"));
}

RunLoop loopBetween(std::size_t from, std::size_t to, double residual, bool left_out)
{
  RunLoop loop;
  loop.run_from = from;
  loop.run_to = to;
  loop.residual = residual;
  loop.left_out = left_out;
  return loop;
}

TEST(MergeTable, HasLoopsAndErrorsOfEachTwoRuns)
{
  const Trajectory drive = test::straightDrive(3, 10);
  Trajectory shifted;  // as estimated: 0.3 m to the side of where it was
  for (const auto& [stamp, pose] : drive)
  {
    shifted.push_back(stamp, Eigen::Translation3d(0, 0.3, 0) * pose);
  }
  const auto runs = test::listOf(runWith("a", drive), runWith("b", drive));
  MergedRuns joined;
  joined.merge.loops = {loopBetween(0, 1, 0.3, false), loopBetween(1, 0, 0.4, false),
                        loopBetween(0, 1, 50, true)};
  joined.truth = {drive, drive};
  EXPECT_EQ(
      "runs,loops,left out,residual [m],places,error: median [m],RMSE,max\n"
      "a - b,3,1,0.353553391,3,0.3,0.3,0.3\n",
      mergeTable(runs, joined, {drive, shifted}).toCsv());
}

TEST(MergeTable, WithoutGroundTruthItHasLoopsAlone)
{
  const Trajectory drive = test::straightDrive(3, 10);
  const auto runs = test::listOf(runWith("a", drive), runWith("b", drive), runWith("c", drive));
  MergedRuns joined;
  joined.merge.loops = {loopBetween(2, 0, 0.5, false)};
  joined.truth.resize(3);
  const Table table = mergeTable(runs, joined, {drive, Trajectory(), drive});
  EXPECT_EQ(1U, table.rows()) << "runs without a loop and a place in common have no row";
  EXPECT_EQ(
      "runs,loops,left out,residual [m],places,error: median [m],RMSE,max\n"
      "a - c,1,0,0.5,,,,\n",
      table.toCsv());
}

TEST(MergeTable, PlacesAreWithinFiveMetres)
{
  const Trajectory drive = test::straightDrive(3, 10);
  const Trajectory beside = test::straightDrive(3, 10, 16);  // 16, 26, 36 m; at 16: 4 m from 20
  const auto runs = test::listOf(runWith("a", drive), runWith("b", beside));
  MergedRuns joined;
  joined.truth = {drive, beside};
  EXPECT_EQ(
      "runs,loops,left out,residual [m],places,error: median [m],RMSE,max\n"
      "a - b,0,0,,1,0,0,0\n",
      mergeTable(runs, joined, {drive, beside}).toCsv());
}

TEST(ReferenceTable, HasARowForEachRunWithReferences)
{
  const Trajectory drive = test::straightDrive(3, 10);
  const auto runs =
      test::listOf(runWith("monday", drive), runWith("tuesday", drive), runWith("friday", drive));
  RunMerge merge;
  merge.fits.resize(3);
  merge.fits[1].positions = 12;
  merge.fits[1].horizontal_rmse = 0.456;
  merge.fits[1].vertical_rmse = 1.234;
  merge.fits[2].up_error = 0.01;
  merge.fits[2].up_sigma = 0.005;
  const Table table = referenceTable(runs, merge);
  EXPECT_EQ(2U, table.rows());
  EXPECT_EQ("run,positions,horizontal RMSE [m],vertical RMSE [m],vertical off [deg],sigma [deg]",
            firstLine(table.toCsv()));
  EXPECT_TRUE(contains(table.toCsv(), "tuesday,12,0.456,1.234,,")) << table.toCsv();
  EXPECT_TRUE(contains(table.toCsv(), "friday,,,,0.57295779")) << table.toCsv();
  merge.fits.assign(3, ReferenceFit());
  EXPECT_EQ(0U, referenceTable(runs, merge).rows());
}
}  // namespace
}  // namespace dyslam
