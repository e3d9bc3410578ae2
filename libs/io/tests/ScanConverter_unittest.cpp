// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/Converters.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ScanFolders.h"

namespace dyslam
{
TEST(ScanConverter, StampsFromNames)
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

/** Without trailing zeros, names are not in the order of their times. A date is no time. */
TEST(ScanConverter, NamesInTheOrderOfTheirTimes)
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
  for (const char* name : {"dates", "two"})
  {
    const auto result =
        convertScans(folder.file(name), folder.file("y.rawlog"), ScanConverterOptions{});
    EXPECT_TRUE(contains(result.notes.at(0), "are not taken as time stamps")) << result.notes[0];
  }
}

/** As ROS 2's pointcloud_to_pcd wrote them: seconds and a count of nanoseconds. */
TEST(ScanConverter, NanosecondsWithoutLeadingZeros)
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

TEST(ScanConverter, FilesOfNuScenes)
{
  const TestFolder folder;
  const std::string base = "in/n008-2018-08-01-15-16-36-0400__LIDAR_TOP__15331516035";
  folder.write(base + "47590.pcd.bin", fiveColumns(0));
  folder.write(base + "97590.pcd.bin", fiveColumns(1));
  ScanConverterOptions options;
  const auto result = convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(contains(result.notes.at(0), "time stamps: the file names")) << result.notes[0];
  EXPECT_TRUE(contains(result.notes.at(1), "x y z intensity ring")) << result.notes[1];
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(2U, frames.size());
  EXPECT_NEAR(1533151603.59759, frames[1].scan.stamp, 1e-6);
  ASSERT_EQ(320U, frames[1].scan.size());
  EXPECT_TRUE(frames[1].scan.points[33].isApprox(Eigen::Vector3f(6.7F, -2.7F, 0.34F), 1e-5F));
  EXPECT_EQ(1.0F, frames[1].scan.intensity[33]);
  EXPECT_EQ(1, frames[1].scan.ring[33]);
  // As requested, whatever the content looks like.
  options.bin_layout = BinLayout::xyzi;
  EXPECT_EQ(800U, convertScans(folder.file("in"), folder.file("x.rawlog"), options).points);
  options.bin_layout = BinLayout::xyzir;
  writeBins(folder, "four", 1);
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("four"), folder.file("x.rawlog"), options); }),
      "000000.bin"));
}

TEST(ScanConverter, ARangeOfTimeAndEveryNthScan)
{
  const TestFolder folder;
  writeBins(folder, "in", 10);
  ScanConverterOptions options;
  options.dt = 0.1;
  options.skip_first_n = 1;
  options.start = 0.3;
  options.end = 0.8;
  options.every_n = 2;
  const auto convert = [&]
  { return convertScans(folder.file("in"), folder.file("x.rawlog"), options); };
  EXPECT_TRUE(contains(convert().warnings.back(), "preprocess.deskew=none"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(3U, frames.size());
  EXPECT_TRUE(samePoints(someScan(3, 13), frames[0].scan));
  EXPECT_TRUE(samePoints(someScan(7, 17), frames[2].scan));
  EXPECT_NEAR(0.2, frames[1].scan.stamp - frames[0].scan.stamp, 1e-6);
  options.every_n = 1;
  EXPECT_FALSE(contains(convert().warnings.back(), "preprocess.deskew=none"));
  EXPECT_EQ(5U, convert().scans);
  options.start = 1;
  options.end = 0;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convert(); }),
                       "--start and --end leave none of the 10 scans"));
}

/** As PCL writes a column that no driver filled. */
TEST(ScanConverter, EqualTimesOfPointsAreNone)
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
    const bool missing = contains(result.warnings.back(), "the points have no times");
    const auto frames = readAll(folder.file("x.rawlog"));
    EXPECT_EQ(missing, frames.at(0).scan.time.empty() && frames.at(1).scan.time.empty());
    EXPECT_EQ(missing, contains(result.warnings.back(), "(those of a scan are all the same)"));
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

/** Drivers that give a scan the time of its last point. */
TEST(ScanConverter, PointTimesCountFromTheStampOfTheName)
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
  const auto check = [&](const std::string& name, float first, bool warned)
  {
    const auto result =
        convertScans(folder.file(name), folder.file("x.rawlog"), ScanConverterOptions{});
    EXPECT_EQ(warned, !result.warnings.empty()) << name;
    EXPECT_EQ(warned, warned && contains(result.warnings[0], "clock")) << name;
    EXPECT_TRUE(contains(result.notes.back(), "field t, seconds from the clock's zero"));
    for (const auto& frame : readAll(folder.file("x.rawlog")))
    {
      EXPECT_NEAR(1600000000.1 + 0.1 * static_cast<double>(frame.index), frame.scan.stamp, 1e-6);
      ASSERT_EQ(11U, frame.scan.time.size()) << name;
      EXPECT_NEAR(first, frame.scan.time.front(), 2e-6) << name;
      EXPECT_NEAR(first + 0.1F, frame.scan.time.back(), 2e-6) << name;
    }
  };
  writeScans("last", 1600000000.0);
  check("last", -0.1F, false);
  writeScans("first", 1600000000.1);
  check("first", 0, false);
  writeScans("leap", 1600000037.0);  // GPS time, or that of the lidar's start
  check("leap", 0, true);
}

TEST(ScanConverter, BrightIntensitiesAreLimitedAndScaledOnce)
{
  const TestFolder folder;
  makeFolderOf(folder, "in");
  Scan scan = someScan(0, 3);
  scan.intensity = {51, 255, 3000};
  for (const char* name : {"0", "1"})
  {
    writePcd(folder.file(std::string("in/") + name + ".pcd"), scan.points, scan.intensity);
  }
  const auto result = convertScans(folder.file("in"), folder.file("x.rawlog"), {});
  EXPECT_EQ(1, std::count(result.notes.begin(), result.notes.end(),
                          "intensity: field intensity, limited to 255"));
  for (const auto& frame : readAll(folder.file("x.rawlog")))
  {
    ASSERT_EQ(3U, frame.scan.intensity.size());
    EXPECT_NEAR(0.2F, frame.scan.intensity[0], 1e-6);
    EXPECT_EQ((std::vector<float>{1, 1}),
              (std::vector<float>{frame.scan.intensity[1], frame.scan.intensity[2]}));
  }
}

TEST(ScanConverter, CountedNamesAndTimesOfAFile)
{
  const TestFolder folder;
  writeBins(folder, "in", 2);
  ScanConverterOptions options;
  const auto counted = convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(contains(counted.notes.at(0), "not taken as time stamps"));
  EXPECT_TRUE(contains(counted.warnings.at(0), "0.1 s between scans is assumed"));
  EXPECT_TRUE(contains(counted.warnings.at(1), "points have no times"));
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
  options.times = folder.write("t.txt", "1\n");
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options); }),
      "has 1 times, but there are 2 scans"));
}

TEST(ScanConverter, GapsInTheNumbersOfFiles)
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
TEST(ScanConverter, NumbersOfTenDigits)
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

TEST(ScanConverter, ProgressOfALimitedConversion)
{
  const TestFolder folder;
  writeBins(folder, "in", 8);
  ScanConverterOptions options;
  options.only_first_n = 2;
  std::vector<double> fractions;
  (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options,
                     [&fractions](double fraction, std::size_t) { fractions.push_back(fraction); });
  EXPECT_EQ((std::vector<double>{0.5, 1}), fractions);
}

TEST(ScanConverter, FilesWithoutPointsAreReported)
{
  const TestFolder folder;
  writeBins(folder, "in", 3);
  folder.write("in/000001.bin", "");
  const auto result = convertScans(folder.file("in"), folder.file("x.rawlog"), {});
  EXPECT_EQ(3U, result.scans);
  EXPECT_EQ("1 file without points, the first is 000001.bin: empty scans are written",
            result.warnings.at(0));
}

TEST(ScanConverter, FoldersOfEachKind)
{
  const TestFolder folder;
  for (const std::string kind : {"bin", "pcd", "ply"})
  {
    makeFolderOf(folder, kind);
    for (std::size_t i = 0; i < 3; ++i)
    {
      Scan scan = someScan(i, 5 + i);
      scan.intensity.back() = 255;
      writeCloud(folder.file(kind + "/" + std::to_string(8 + i) + "." + kind), scan.points,
                 scan.intensity);
    }
    ScanConverterOptions options;
    options.sensor = "my-lidar";
    options.dt = 0.05;
    const auto result = convertScans(folder.file(kind), folder.file(kind + ".rawlog"), options);
    EXPECT_EQ(3U, result.scans);
    EXPECT_EQ("", result.ground_truth);
    const auto frames = readAll(folder.file(kind + ".rawlog"));
    ASSERT_EQ(3U, frames.size());
    EXPECT_TRUE(samePoints(someScan(2, 7), frames[2].scan));
    EXPECT_EQ(1.0F, frames[2].scan.intensity.back());
    EXPECT_NEAR(0.1, frames[2].scan.stamp, 1e-9);
    EXPECT_EQ("my-lidar", frames[2].scan.sensor_label);
  }
}

TEST(ScanConverter, PosesAndStaleTruth)
{
  const TestFolder folder;
  writeBins(folder, "in", 2);
  writeKittiPoses(folder.file("poses.txt"), std::vector<Pose>{somePose(0), somePose(1)});
  ScanConverterOptions options;
  options.poses = folder.file("poses.txt");
  EXPECT_EQ(2U, convertScans(folder.file("in"), folder.file("x.rawlog"), options).poses);
  EXPECT_TRUE(
      readAll(folder.file("x.rawlog"))[1].T_world_vehicle_truth->isApprox(somePose(1), 1e-9));
  EXPECT_EQ(PoseSource::given, poseOrigin(folder.file("x.gt")).source);
  options.pose_source = PoseSource::simulated;
  (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(poseOrigin(folder.file("x.gt")).isExact());
  options.poses = "";
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options); }),
      "--pose-source"));
  options.pose_source = PoseSource::unknown;
  EXPECT_EQ(0U, convertScans(folder.file("in"), folder.file("x.rawlog"), options).poses);
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.gt/poses_tum.txt")));
}

TEST(ScanConverter, SectorsOfRevolutions)
{
  const TestFolder folder;
  // Warned for scans of a width [deg], each turned by an angle [deg] from the one before.
  const auto isWarned = [&folder](double width, double turn)
  {
    makeFolderOf(folder, "in");
    for (std::size_t i = 0; i < 12; ++i)
    {
      std::vector<Eigen::Vector3f> points;
      for (std::size_t k = 0; k < 60; ++k)
      {
        const double angle =
            (turn * static_cast<double>(i) + width * static_cast<double>(k) / 60) * M_PI / 180;
        points.emplace_back(
            Eigen::Vector3d(9 * std::cos(angle), 9 * std::sin(angle), 0.5).cast<float>());
      }
      points.emplace_back(0, 0, 0);
      writeBin(folder.file("in/" + number(i, 2) + ".bin"), points, {});
    }
    const auto result = convertScans(folder.file("in"), folder.file("x.rawlog"), {});
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [](const std::string& line)
                       { return contains(line, "only sectors of a revolution"); });
  };
  EXPECT_TRUE(isWarned(36, 36));
  EXPECT_TRUE(isWarned(120, -120));
  EXPECT_FALSE(isWarned(70, 0)) << "solid state";
  EXPECT_FALSE(isWarned(360, 36));
}

TEST(ScanConverter, ColumnsThatAreNoIntensities)
{
  const TestFolder folder;
  const Scan scan = someScan(0, 12);
  std::string bytes;  // x y z
  for (const Eigen::Vector3f& point : scan.points)
  {
    bytes.append(reinterpret_cast<const char*>(point.data()), 3 * sizeof(float));
  }
  folder.write("three/0.bin", "");
  folder.write("three/1.bin", bytes);
  writeBins(folder, "four", 2);
  const auto isWarned = [&folder](const std::string& name)
  {
    const auto result = convertScans(folder.file(name), folder.file("x.rawlog"), {});
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [](const std::string& line)
                       { return contains(line, "1.bin: 33 % of the intensities are negative"); });
  };
  EXPECT_TRUE(isWarned("three"));
  EXPECT_FALSE(isWarned("four"));
}

/** Coordinates in millimetres give a warning, those that no lidar measures are an error. */
TEST(ScanConverter, PointsThatAreNotInMetres)
{
  const TestFolder folder;
  const auto write = [&folder](const std::string& name, float scale, float origin)
  {
    Scan scan = someScan(0, 60);
    for (Eigen::Vector3f& point : scan.points)
    {
      point = scale * point + Eigen::Vector3f(origin, origin, 0);
    }
    makeFolderOf(folder, name.substr(0, name.find('/')));
    writeCloud(folder.file(name), scan.points, scan.intensity);
  };
  write("m/0.bin", 1, 0);
  write("mm/0.bin", 1000, 0);
  write("utm/0.pcd", 1, 5e6F);
  write("odd/0.bin", 1, 5e6F);
  ScanConverterOptions options;
  const auto converted = [&](const std::string& name)
  { return convertScans(folder.file(name), folder.file("x.rawlog"), options); };
  const auto isWarned = [&](const std::string& name)
  {
    const auto warnings = converted(name).warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& line)
                       { return contains(line, "in millimetres (--scale 0.001)"); });
  };
  EXPECT_FALSE(isWarned("m"));
  EXPECT_TRUE(isWarned("mm"));
  options.scale = 0.001;
  EXPECT_FALSE(isWarned("mm"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(60U, frames.at(0).scan.size());
  EXPECT_TRUE(frames[0].scan.points[50].isApprox(someScan(0, 60).points[50], 1e-6F));
  EXPECT_EQ(someScan(0, 60).intensity, frames[0].scan.intensity);
  for (const double nonsense : {0.0, -0.001, std::nan("")})
  {
    options.scale = nonsense;
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { converted("mm"); }), "scale"));
  }
  options.scale = 1;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { converted("utm"); }),
                       "0.pcd: half of its points are more than 100 km from the origin: its "
                       "coordinates are not relative to the lidar"));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { converted("odd"); }),
                       "its columns are probably not x y z intensity"));
}

TEST(ScanConverter, Errors)
{
  const TestFolder folder;
  ScanConverterOptions options;
  const auto message = [&](const std::string& input)
  {
    return messageOfError<UserError>([&]
                                     { convertScans(input, folder.file("x.rawlog"), options); });
  };
  EXPECT_TRUE(contains(message(folder.file("none")), "no such file"));
  makeFolderOf(folder, "in");
  EXPECT_TRUE(contains(message(folder.file("in")), "has no .bin"));
  EXPECT_TRUE(contains(message(folder.write("a.bin", "")), "single scan"));
  EXPECT_TRUE(contains(message(folder.write("a.pcap", "nonsense")), "not a network capture"));
  EXPECT_TRUE(contains(message(folder.write("a.pcapng.gz", "")), "unpack it first: gunzip -k "));
  options.sensor = "VLP99";
  EXPECT_TRUE(contains(message(folder.file("a.pcap")), "--sensor VLP99"));
}

TEST(ScanConverter, AnErrorBehindTheFirstScanLeavesAnEarlierRecording)
{
  const TestFolder folder;
  writeBins(folder, "in", 4);
  writeKittiPoses(folder.file("poses.txt"),
                  std::vector<Pose>{somePose(0), somePose(1), somePose(2), somePose(3)});
  ScanConverterOptions options;
  options.poses = folder.file("poses.txt");
  (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  const std::string earlier = folder.read("x.rawlog");
  const std::string earlier_truth = folder.read("x.gt/poses_tum.txt");
  std::filesystem::resize_file(folder.file("in/000002.bin"), 17);
  const auto message = [&](const std::string& output)
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(folder.file("in"), folder.file(output), options); });
  };
  EXPECT_TRUE(contains(message("x.rawlog"), "000002.bin"));
  EXPECT_TRUE(contains(message("x.rawlog"), "; the earlier " + folder.file("x.rawlog") + " stays"));
  EXPECT_EQ(earlier, folder.read("x.rawlog"));
  EXPECT_EQ(earlier_truth, folder.read("x.gt/poses_tum.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog.tmp")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.gt.tmp")));

  EXPECT_TRUE(
      contains(message("new.rawlog"), "; the scans before it are in " + folder.file("new.rawlog")));
  EXPECT_EQ(2U, readAll(folder.file("new.rawlog")).size());
  EXPECT_TRUE(std::filesystem::exists(folder.file("new.gt/poses_tum.txt")));
}

/** A program that is killed at that moment leaves no rawlog beside the truth of another. */
TEST(ScanConverter, TheTruthOfAnEarlierRecordingGoesBeforeItsRawlog)
{
  const TestFolder folder;
  writeBins(folder, "in", 2);
  writeKittiPoses(folder.file("poses.txt"), std::vector<Pose>{somePose(0), somePose(1)});
  ScanConverterOptions options;
  options.poses = folder.file("poses.txt");
  (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  ASSERT_TRUE(std::filesystem::exists(folder.file("x.gt/poses_tum.txt")));
  const auto block = [&](double, std::size_t scans)
  {
    if (scans == 2)
    {
      std::filesystem::remove(folder.file("x.rawlog"));
      folder.write("x.rawlog/a", "no file can replace this folder");
    }
  };
  EXPECT_THROW((void)convertScans(folder.file("in"), folder.file("x.rawlog"), options, block),
               UserError);
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.gt/poses_tum.txt")));
}
}  // namespace dyslam
