// SPDX-License-Identifier: BSD-3-Clause
// Times of the scans and points of a folder: by names, files and fields.
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "ScanFolders.h"

namespace dyslam
{
TEST(ScanTimes, StampsFromNames)
{
  const TestFolder folder;
  struct Case
  {
    const char* folder;
    const char* first;
    const char* second;
  };
  for (const Case& names : {Case{"s", "1600000000.250", "1600000000.500"},
                            Case{"split", "1600000000_250", "1600000000_500"},
                            Case{"prefix", "cloud_1600000000.250", "cloud_1600000000.500"},
                            Case{"both", "cloud_1600000000_250", "cloud_1600000000_500"},
                            Case{"ms", "1600000000250", "1600000000500"},
                            Case{"us", "1600000000250000", "1600000000500000"},
                            Case{"ns", "1600000000250000000", "1600000000500000000"}})
  {
    makeFolderOf(folder, names.folder);
    const std::string base = std::string(names.folder) + "/";
    const Scan scan = someScan(0, 5);
    writeBin(folder.file(base + names.first + ".bin"), scan.points, scan.intensity);
    writeBin(folder.file(base + names.second + ".bin"), scan.points, scan.intensity);
    const auto result =
        convertScans(folder.file(names.folder), folder.file("x.rawlog"), ScanConverterOptions{});
    const auto frames = readAll(folder.file("x.rawlog"));
    EXPECT_NEAR(1600000000.25, frames.at(0).scan.stamp, 1e-6) << names.folder;
    EXPECT_NEAR(1600000000.5, frames.at(1).scan.stamp, 1e-6) << names.folder;
    EXPECT_TRUE(contains(result.notes.at(0), "time stamps: the file names")) << names.folder;
  }
}

/** Without trailing zeros, names are not in the order of their times. A date is no time, nor is a
 * count from the start of a recorder (milliseconds and microseconds). */
TEST(ScanTimes, NamesInTheOrderOfTheirTimes)
{
  const TestFolder folder;
  makeFolderOf(folder, "s");
  makeFolderOf(folder, "dates");
  makeFolderOf(folder, "two");
  const Scan early = someScan(0, 5);
  const Scan late = someScan(1, 7);
  writeBin(folder.file("s/1600000000.15.bin"), late.points, late.intensity);
  writeBin(folder.file("s/1600000000.05125.bin"), early.points, early.intensity);
  (void)convertScans(folder.file("s"), folder.file("x.rawlog"), ScanConverterOptions{});
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(1600000000.05125, frames.at(0).scan.stamp, 1e-6);
  EXPECT_EQ(early.size(), frames[0].scan.size());
  EXPECT_NEAR(1600000000.15, frames.at(1).scan.stamp, 1e-6);
  writeBin(folder.file("dates/20180801151636123.bin"), early.points, early.intensity);
  writeBin(folder.file("dates/20180801151636223.bin"), late.points, late.intensity);
  writeBin(folder.file("two/left_1600000000.0.bin"), early.points, early.intensity);
  writeBin(folder.file("two/right_1600000000.5.bin"), late.points, late.intensity);
  makeFolderOf(folder, "milliseconds");
  makeFolderOf(folder, "microseconds");
  writeBin(folder.file("milliseconds/251370668.bin"), early.points, early.intensity);
  writeBin(folder.file("milliseconds/251370769.bin"), late.points, late.intensity);
  writeBin(folder.file("microseconds/251370668000.bin"), early.points, early.intensity);
  writeBin(folder.file("microseconds/251370769000.bin"), late.points, late.intensity);
  for (const char* name : {"dates", "two", "milliseconds", "microseconds"})
  {
    const auto result =
        convertScans(folder.file(name), folder.file("y.rawlog"), ScanConverterOptions{});
    EXPECT_TRUE(contains(result.notes.at(0), "are not taken as time stamps")) << result.notes[0];
  }
}

/** Times of a simulator, or since the computer was started: names are not in their order, either.
 */
TEST(ScanTimes, SecondsFromAnotherStartInNames)
{
  const TestFolder folder;
  const auto convert = [&](const std::vector<std::string>& names)
  {
    std::filesystem::remove_all(folder.file("s"));
    makeFolderOf(folder, "s");
    for (const std::string& name : names)
    {
      const Scan scan = someScan(0, 5);
      writeBin(folder.file("s/" + name + ".bin"), scan.points, scan.intensity);
    }
    return convertScans(folder.file("s"), folder.file("x.rawlog"), ScanConverterOptions{});
  };
  const ConversionResult result = convert({"12.3", "12.071", "12.182"});
  EXPECT_TRUE(hasLine(result.notes, "time stamps: the file names (12.071.bin)"));
  EXPECT_FALSE(hasLine(result.warnings, "is assumed"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(3U, frames.size());
  EXPECT_NEAR(0.111, frames[1].scan.stamp - frames[0].scan.stamp, 1e-6);
  EXPECT_NEAR(0.118, frames[2].scan.stamp - frames[1].scan.stamp, 1e-6);
  // Versions, counts of files, steps that are none of scans, a number twice, names without a point.
  for (const std::vector<std::string>& names : {std::vector<std::string>{"1.1", "1.2"},
                                                {"1_000", "1_100"},
                                                {"1.000", "2.000", "99.000"},
                                                {"1.001", "1.002"},
                                                {"1.100", "1.10"},
                                                {"1.000", "2"}})
  {
    EXPECT_TRUE(hasLine(convert(names).notes, "are not taken as time stamps")) << names[0];
  }
  folder.write("times.txt", "0\n0.3\n");
  EXPECT_TRUE(hasLine(convert({"12.300", "12.400"}).notes, "times.txt")) << "is told explicitly";
}

/** As ROS 2's pointcloud_to_pcd wrote them: seconds and a count of nanoseconds. */
TEST(ScanTimes, NanosecondsWithoutLeadingZeros)
{
  const TestFolder folder;
  const auto stampsOf = [&](const std::vector<std::string>& names)
  {
    std::filesystem::remove_all(folder.file("s"));
    makeFolderOf(folder, "s");
    for (const std::string& name : names)
    {
      const Scan scan = someScan(0, 5);
      writeBin(folder.file("s/" + name + ".bin"), scan.points, scan.intensity);
    }
    const auto result =
        convertScans(folder.file("s"), folder.file("x.rawlog"), ScanConverterOptions{});
    std::vector<double> stamps;
    for (const auto& frame : readAll(folder.file("x.rawlog")))
    {
      stamps.push_back(frame.scan.stamp);
    }
    EXPECT_EQ(stamps.front() < 1e8, contains(result.notes.at(0), "not taken as time stamps"));
    return stamps;
  };
  for (const std::string point : {".", "_"})
  {
    const auto stamps = stampsOf({"1600000000" + point + "150000000", "1600000000" + point + "0",
                                  "1600000000" + point + "50000000"});
    ASSERT_EQ(3U, stamps.size());
    EXPECT_NEAR(1600000000.0, stamps[0], 1e-6);
    EXPECT_NEAR(1600000000.05, stamps[1], 1e-6);
    EXPECT_NEAR(1600000000.15, stamps[2], 1e-6);
  }
  // A zero before other digits: decimals without trailing zeros.
  EXPECT_NEAR(1600000000.5, stampsOf({"1600000000.050000001", "1600000000.5"}).at(1), 1e-6);
  EXPECT_NEAR(1600000001.0, stampsOf({"1600000000.25", "1600000001"}).at(1), 1e-6);
  // Milliseconds or decimals?
  EXPECT_NEAR(0.1, stampsOf({"1600000000.50", "1600000000.150"}).at(1), 1e-6);
}

TEST(ScanTimes, CountedNamesAndTimesOfAFile)
{
  const TestFolder folder;
  writeBins(folder, "in", 2);
  ScanConverterOptions options;
  const auto counted = convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(contains(counted.notes.at(0), "not taken as time stamps"));
  EXPECT_TRUE(contains(counted.warnings.at(0), "0.1 s between scans is assumed"));
  EXPECT_TRUE(hasLine(counted.notes, "points have no times"));
  for (const std::string text :
       {"5\n5.25\n", "1600000005\n1600000005.25\n", "1600000005000000000\n1600000005250000000\n",
        "2011-09-26 13:02:25.5\n2011-09-26 13:02:25.75\n",
        "2011-09-26 13:02:25.5\n\n2011-09-26 13:02:25.75\n"})
  {
    options.times = folder.write("t.txt", text);
    (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options);
    const auto frames = readAll(folder.file("x.rawlog"));
    EXPECT_NEAR(0.25, frames.at(1).scan.stamp - frames[0].scan.stamp, 1e-6) << text;
  }
  const auto isWarned = [&](const std::string& text)
  {
    options.times = folder.write("t.txt", text);
    const auto warnings =
        convertScans(folder.file("in"), folder.file("x.rawlog"), options).warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& line)
                       { return contains(line, "s apart: times that count from the start"); });
  };
  EXPECT_FALSE(isWarned("0\n0.1\n"));
  EXPECT_FALSE(isWarned("1600000005000\n1600000005250\n"));
  EXPECT_TRUE(isWarned("0\n100000000\n"));
  EXPECT_TRUE(isWarned("0\n0.0001\n"));
  options.times = folder.write("t.txt", "1\n");
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options); }),
      "has 1 time, but there are 2 scans"));
}

TEST(ScanTimes, AFileOfTimesWithTheScansIsFound)
{
  const TestFolder folder;
  writeBins(folder, "drive/scans", 2);
  const auto converted = [&](const ScanConverterOptions& options = {})
  { return convertScans(folder.file("drive/scans"), folder.file("x.rawlog"), options); };
  const auto step = [&]
  {
    const auto frames = readAll(folder.file("x.rawlog"));
    return frames.at(1).scan.stamp - frames.at(0).scan.stamp;
  };
  const std::string above = folder.write("drive/times.txt", "0\n0.3\n");
  ConversionResult result = converted();
  EXPECT_TRUE(hasLine(result.notes, "time stamps: " + above));
  EXPECT_FALSE(hasLine(result.warnings, "is assumed"));
  EXPECT_NEAR(0.3, step(), 1e-6);

  const std::string beside = folder.write("drive/scans/timestamps.txt",
                                          "2011-09-26 13:02:25.5\n\n2011-09-26 13:02:25.75\n");
  result = converted();
  EXPECT_TRUE(hasLine(result.notes, "time stamps: " + beside));
  EXPECT_NEAR(0.25, step(), 1e-6);

  ScanConverterOptions options;
  options.dt = 0.5;
  EXPECT_FALSE(hasLine(converted(options).notes, "time stamps: "));
  EXPECT_NEAR(0.5, step(), 1e-6);
}

TEST(ScanTimes, TheTimesOfASequenceOfKittiTrackingAreFound)
{
  const TestFolder folder;
  writeBins(folder, "training/velodyne/0003", 2);
  const std::string times = folder.write("training/times/0003.txt", "0\n0.3\n");
  const ConversionResult result =
      convertScans(folder.file("training/velodyne/0003"), folder.file("x.rawlog"), {});
  EXPECT_TRUE(hasLine(result.notes, "time stamps: " + times));
  EXPECT_NEAR(0.3, readAll(folder.file("x.rawlog")).at(1).scan.stamp, 1e-6);
}

TEST(ScanTimes, AFileOfTimesThatDoesNotFitIsNotUsed)
{
  const TestFolder folder;
  writeBins(folder, "drive/scans", 2);
  for (const auto& [text, why] :
       {std::pair("0\n0.3\n0.6\n", "it has 3 times, but there are 2 scans"),
        std::pair("0.3\n0.3\n", "the time does not come after that of the line before"),
        std::pair("time\n0\n0.3\n", "times.txt:1")})
  {
    const std::string file = folder.write("drive/times.txt", text);
    const ConversionResult result =
        convertScans(folder.file("drive/scans"), folder.file("x.rawlog"), {});
    EXPECT_TRUE(hasLine(result.warnings, file + " is not used: ")) << text;
    EXPECT_TRUE(hasLine(result.warnings, why)) << text;
    EXPECT_TRUE(hasLine(result.warnings, "0.1 s between scans is assumed; give --dt, or a file"))
        << text;
  }
  folder.write("drive/times.txt", "0\n0.3\n");
  folder.write("drive/timestamps.txt", "0\n0.4\n");
  EXPECT_TRUE(
      hasLine(convertScans(folder.file("drive/scans"), folder.file("x.rawlog"), {}).warnings,
              "times.txt and timestamps.txt are not used"));
}

/** Times of the scans themselves, in their names or fields, are not replaced. */
TEST(ScanTimes, AFileOfTimesDoesNotReplaceThoseOfTheScans)
{
  const TestFolder folder;
  folder.write("times.txt", "5\n5.5\n");
  makeFolderOf(folder, "named");
  makeFolderOf(folder, "timed");
  for (const std::string i : {"1", "2"})
  {
    const Scan scan = someScan(0, 5);
    writeBin(folder.file("named/1600000000." + i + ".bin"), scan.points, scan.intensity);
    folder.write("timed/" + i + ".pcd",
                 "FIELDS x y z t\nSIZE 4 4 4 8\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
                 "DATA ascii\n5 0 0 1600000000." +
                     i + "\n0 5 0 1600000000." + i + "5\n");
  }
  for (const char* name : {"named", "timed"})
  {
    const ConversionResult result = convertScans(folder.file(name), folder.file("x.rawlog"), {});
    EXPECT_FALSE(hasLine(result.notes, "times.txt")) << name;
    EXPECT_NEAR(1600000000.1, readAll(folder.file("x.rawlog")).at(0).scan.stamp, 1e-3) << name;
  }
}

TEST(ScanTimes, TheScansOfAKittiRecordingAreBetterGivenWithIt)
{
  const TestFolder folder;
  writeBins(folder, "sequences/00/velodyne", 2);
  folder.write("sequences/00/times.txt", "0\n0.3\n");
  const ConversionResult result =
      convertScans(folder.file("sequences/00/velodyne/"), folder.file("x.rawlog"), {});
  EXPECT_TRUE(hasLine(result.notes, "time stamps: " + folder.file("sequences/00/times.txt")));
  EXPECT_TRUE(hasLine(result.warnings, "give its folder, -i " + folder.file("sequences/00") + ","));
  writeBins(folder, "plain", 2);
  EXPECT_FALSE(
      hasLine(convertScans(folder.file("plain"), folder.file("x.rawlog"), {}).warnings, "KITTI"));
}

TEST(ScanTimes, GapsInTheNumbersOfFiles)
{
  const TestFolder folder;
  makeFolderOf(folder, "in");
  for (const char* name : {"f_000000", "f_000024", "f_000048", "f_000049"})
  {
    const Scan scan = someScan(0, 5);
    writeBin(folder.file("in/" + std::string(name) + ".bin"), scan.points, scan.intensity);
  }
  const auto converted = [&](const ScanConverterOptions& options)
  {
    const auto warnings =
        convertScans(folder.file("in"), folder.file("x.rawlog"), options).warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& warning)
                       {
                         return contains(warning,
                                         "file numbers have gaps: f_000024.bin follows "
                                         "f_000000.bin; scans are taken as 0.");
                       });
  };
  const auto stampsOfScans = [&]
  {
    std::vector<double> stamps;
    for (const auto& frame : readAll(folder.file("x.rawlog")))
    {
      stamps.push_back(frame.scan.stamp);
    }
    return stamps;
  };
  ScanConverterOptions options;
  EXPECT_TRUE(converted(options));
  options.dt = 0.25;
  EXPECT_TRUE(converted(options));
  EXPECT_NEAR(0.75, stampsOfScans().at(3), 1e-6);
  options.by_number = true;
  EXPECT_FALSE(converted(options));
  EXPECT_NEAR(6, stampsOfScans().at(1), 1e-6);
  EXPECT_NEAR(12.25, stampsOfScans().at(3), 1e-6);
  options.dt = 0;
  EXPECT_FALSE(converted(options));
  EXPECT_NEAR(4.9, stampsOfScans().at(3), 1e-6);

  writeBins(folder, "whole", 3);
  EXPECT_FALSE(contains(
      convertScans(folder.file("whole"), folder.file("x.rawlog"), {}).warnings.at(0), "gaps"));
  folder.write("in/g_7.bin", "");
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options); }),
      "in: --by-number: the file names do not end in ascending numbers"));
}

/** As KITTI's raw recordings have them. */
TEST(ScanTimes, NumbersOfTenDigits)
{
  const TestFolder folder;
  makeFolderOf(folder, "in");
  for (const char* name : {"0000000000", "0000000008", "0000000010"})
  {
    const Scan scan = someScan(0, 5);
    writeBin(folder.file("in/" + std::string(name) + ".bin"), scan.points, scan.intensity);
  }
  ScanConverterOptions options;
  const auto warnings = convertScans(folder.file("in"), folder.file("x.rawlog"), options).warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(),
                          [](const std::string& warning)
                          { return contains(warning, "0000000008.bin follows 0000000000.bin"); }));
  options.by_number = true;
  (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(3U, frames.size());
  EXPECT_NEAR(0.8, frames[1].scan.stamp, 1e-6);
  EXPECT_NEAR(1.0, frames[2].scan.stamp, 1e-6);
}

/** As PCL writes a column that no driver filled. */
TEST(ScanTimes, EqualTimesOfPointsAreNone)
{
  const TestFolder folder;
  const auto pcd = [](const std::string& points)
  {
    return "VERSION 0.7\nFIELDS x y z time\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\n"
           "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n" +
           points;
  };
  makeFolderOf(folder, "in");
  const auto timesAfter = [&]
  {
    const auto result =
        convertScans(folder.file("in"), folder.file("x.rawlog"), ScanConverterOptions{});
    const bool missing = hasLine(result.warnings, "the points have no times");
    const auto frames = readAll(folder.file("x.rawlog"));
    EXPECT_EQ(missing, frames.at(0).scan.time.empty() && frames.at(1).scan.time.empty());
    EXPECT_EQ(missing, hasLine(result.warnings, "(those of a scan are all the same)"));
    return std::pair(frames[0].scan.time, frames[1].scan.time);
  };
  const std::string equal = pcd("5 0 0 0\n0 5 0 0\n5 5 0 0\n");
  folder.write("in/0.pcd", equal);
  folder.write("in/1.pcd", pcd("5 0 0 0.05\n0 5 0 0.05\n5 5 0 nan\n"));
  EXPECT_EQ(timesAfter(), std::pair(std::vector<float>(), std::vector<float>()));
  // Once times were met, a scan of one firing has its time.
  folder.write("in/0.pcd", pcd("5 0 0 0\n0 5 0 0.01\n5 5 0 0.02\n"));
  folder.write("in/1.pcd", equal);
  EXPECT_EQ(timesAfter(), std::pair(std::vector<float>{0, 0.01F, 0.02F}, std::vector<float>(3, 0)));
}

TEST(ScanTimes, PointTimesCountFromTheStampOfTheName)
{
  const TestFolder folder;
  const auto writeScans = [&](const std::string& name, double clock)
  {
    makeFolderOf(folder, name);
    for (const int scan : {1, 2})
    {
      std::string pcd =
          "FIELDS x y z t\nSIZE 4 4 4 8\nTYPE F F F F\nWIDTH 11\nHEIGHT 1\nPOINTS 11\nDATA ascii\n";
      for (int i = 0; i <= 10; ++i)
      {
        pcd += "5 " + std::to_string(i) + " 0 " +
               std::to_string(clock + 0.1 * (scan - 1) + 0.01 * i) + "\n";
      }
      folder.write(name + "/1600000000." + std::to_string(scan) + "00.pcd", pcd);
    }
  };
  const auto check = [&](const std::string& name, double moved, bool warned)
  {
    const auto result =
        convertScans(folder.file(name), folder.file("x.rawlog"), ScanConverterOptions{});
    EXPECT_EQ(warned, !result.warnings.empty()) << name;
    EXPECT_EQ(warned, warned && contains(result.warnings[0], "clock")) << name;
    EXPECT_TRUE(hasLine(result.notes, "field t, seconds from the clock's zero")) << name;
    EXPECT_EQ(moved != 0, hasLine(result.notes, "moved by 0.1")) << name;
    for (const auto& frame : readAll(folder.file("x.rawlog")))
    {
      EXPECT_NEAR(1600000000.1 + moved + 0.1 * static_cast<double>(frame.index), frame.scan.stamp,
                  2e-6);
      ASSERT_EQ(11U, frame.scan.time.size()) << name;
      EXPECT_NEAR(0, frame.scan.time.front(), 4e-6) << name;
      EXPECT_NEAR(0.1F, frame.scan.time.back(), 4e-6) << name;
    }
  };
  writeScans("last", 1600000000.0);
  check("last", -0.1, false);  // drivers that give a scan the time of its last point
  writeScans("first", 1600000000.1);
  check("first", 0, false);
  writeScans("leap", 1600000037.0);  // GPS time, or that of the lidar's start
  check("leap", 0, true);
  ScanConverterOptions with_poses;  // those of the stamps
  with_poses.poses =
      folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  (void)convertScans(folder.file("last"), folder.file("x.rawlog"), with_poses);
  RawlogSource source(folder.file("x.rawlog"));
  const auto frames = framesOf(source);
  EXPECT_TRUE(hasLine(source.warnings(), "late in the scans: moved by 0.1")) << "when it is read";
  EXPECT_NEAR(frames.at(1).scan.stamp, 1600000000.1, 2e-6);
  EXPECT_NEAR(frames.at(1).scan.time.front(), 0, 4e-6);
  EXPECT_FALSE(frames.at(0).T_world_vehicle_truth);
  ASSERT_TRUE(frames.at(1).T_world_vehicle_truth);
  EXPECT_NEAR(frames.at(1).T_world_vehicle_truth->translation().x(), 0, 1e-4)
      << "that of the first stamp";
}
}  // namespace dyslam
