// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanTable.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
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
}
}  // namespace dyslam
