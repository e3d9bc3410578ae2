// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/Frame.h>
#include <dyslam/formats/ScanTable.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
TEST(ScanTable, IsReadAsItWasWritten)
{
  const TestFolder folder;
  Frame frame;
  frame.index = 3;
  frame.scan.stamp = 1.5;
  frame.moving = {true, false, true};
  frame.odometry_accepted = true;
  frame.odometry_rejection = "too fast, \"again\"";
  frame.motion.reason = "too few points";
  frame.motion.rmse = 0.125;
  frame.motion.T_previous_current.translation().x() = 1.25;
  frame.is_keyframe = true;
  const std::string row = scanTableRow(frame);
  EXPECT_EQ(row,
            "3,1.500000000,0,2,0,1,0,0.0000,\"too fast, \"\"again\"\"\",0,0,0.1250,"
            "too few points,1.2500,0.0000,1\n");
  frame.index = 5;
  const std::string path = folder.write("scans.csv", scanTableHeader() + row + scanTableRow(frame));
  EXPECT_EQ(scansOfTable(path), (std::vector<std::size_t>{3, 5}));
  EXPECT_EQ(unregisteredScans(path), (std::set<std::size_t>{3, 5}));
  folder.write("scans.csv", scanTableHeader());
  EXPECT_TRUE(scansOfTable(path).empty());
}

TEST(ScanTable, HasNoFiguresOfAMatcherThatMeasuredNothing)
{
  const TestFolder folder;
  Frame frame;
  frame.odometry_accepted = true;
  frame.odometry.status = MotionStatus::converged;
  const std::string without = scanTableRow(frame);
  EXPECT_EQ(without, "0,0.000000000,0,0,,1,,,,0,0,0.0000,,0.0000,0.0000,0\n");
  const std::string path = folder.write("scans.csv", scanTableHeader() + without);
  EXPECT_EQ(scansOfTable(path), std::vector<std::size_t>{0});
  EXPECT_EQ(unregisteredScans(path), std::set<std::size_t>{0});
  frame.odometry.inliers = 120;
  frame.odometry.rmse = 0.25;
  EXPECT_EQ(scanTableRow(frame), "0,0.000000000,0,0,1,1,120,0.2500,,0,0,0.0000,,0.0000,0.0000,0\n");
  frame.odometry = MotionEstimate();
  EXPECT_EQ(scanTableRow(frame), "0,0.000000000,0,0,0,1,0,0.0000,,0,0,0.0000,,0.0000,0.0000,0\n")
      << "it found no motion";
}

TEST(ScanTable, HasTheScansThatWereNotRegistered)
{
  const TestFolder folder;
  const std::string path = folder.write("scans.csv",
                                        "frame,stamp,reason,registered\n"
                                        "0,1.5,,1\n"
                                        "1,1.6,\"too few, or \"\"none\"\"\",0\n"
                                        "3,1.8,\"lost, again\",0\n"
                                        "4,1.9,,1\n");
  EXPECT_EQ(unregisteredScans(path), (std::set<std::size_t>{1, 3}));
}

TEST(ScanTable, NamesTheDamagedLine)
{
  const TestFolder folder;
  for (const char* line : {"1,1.6,lost", "x,1.6,lost,0", ",1.6,lost,0"})
  {
    const std::string path = folder.write(
        "scans.csv", "frame,stamp,reason,registered\n0,1.5,,1\n" + std::string(line) + "\n");
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)unregisteredScans(path); }),
                         "scans.csv:3: "))
        << line;
  }
}

TEST(ScanTable, HasTheScansOfFurtherLidars)
{
  const TestFolder folder;
  const std::string path = folder.write("scan_parts.csv",
                                        "frame,sensor_label,stamp,first_point,points\n"
                                        "7,left,100.250000000,4,3\n"
                                        "7,\"rear,2\",99.500000000,7,1\n");
  const std::vector<ScanPartRow> rows = readScanParts(path);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].frame, 7U);
  EXPECT_EQ(rows[0].sensor_label, "left");
  EXPECT_EQ(rows[0].stamp, 100.25);
  EXPECT_EQ(rows[0].points, 3U);
  EXPECT_EQ(rows[1].sensor_label, "rear,2");
  EXPECT_EQ(rows[1].points, 1U);

  Frame frame;
  frame.index = 7;
  frame.scan.stamp = 100;
  frame.scan.points.resize(8);
  frame.scan.parts.resize(2);
  frame.scan.parts[0].begin = 4;
  frame.scan.parts[0].stamp = 0.25;
  frame.scan.parts[0].sensor_label = "left";
  frame.scan.parts[1].begin = 7;
  frame.scan.parts[1].stamp = -0.5;
  frame.scan.parts[1].sensor_label = "rear,2";
  EXPECT_EQ(scanPartsHeader() + scanPartRows(frame), folder.read("scan_parts.csv"));
  folder.write("scan_parts.csv", "frame,sensor_label,stamp,first_point,points\n7,left,1.5,4,-3\n");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)readScanParts(path); }),
                       "scan_parts.csv:2: '-3' is not a whole number"));
}

TEST(ScanTable, NamesTheMissingColumn)
{
  const TestFolder folder;
  const std::string path = folder.write("scans.csv", "frame,stamp\n0,1.5\n");
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { (void)unregisteredScans(path); }), "registered"));
  EXPECT_THROW((void)unregisteredScans(folder.file("none.csv")), UserError);
  folder.write("scans.csv", "");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)scansOfTable(path); }),
                       "scans.csv: has no column 'frame'; is it the table of a run?"));
}
}  // namespace dyslam
