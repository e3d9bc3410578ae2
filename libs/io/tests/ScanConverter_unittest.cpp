// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanConverter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "ScanFolders.h"

namespace dyslam
{
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
  options.bin_layout = kitti_layout;
  EXPECT_EQ(800U, convertScans(folder.file("in"), folder.file("x.rawlog"), options).points);
  options.bin_layout = nuscenes_layout;
  writeBins(folder, "four", 1);
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertScans(folder.file("four"), folder.file("x.rawlog"), options); }),
      "000000.bin"));
}

TEST(ScanConverter, LayoutsOfBinFiles)
{
  const TestFolder folder;
  folder.write("in/000000.bin", fiveColumns(0));
  ScanConverterOptions options;
  options.bin_layout = "xyz_r";
  const auto result = convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(contains(result.notes.at(1), "x y z _ ring (--bin-layout xyz_r)")) << result.notes[1];
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(1U, frames.size());
  ASSERT_EQ(320U, frames[0].scan.size());
  EXPECT_EQ(1, frames[0].scan.ring[33]);
  const auto refusal = [&](const std::string& input)
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(folder.file(input), folder.file("y.rawlog"), options); });
  };
  makeFolderOf(folder, "pcd");
  writePcd(folder.file("pcd/0.pcd"), {{1, 2, 3}});
  EXPECT_TRUE(contains(refusal("pcd"), "--bin-layout is for .bin files")) << refusal("pcd");
  options.bin_layout = "xy";
  EXPECT_TRUE(contains(refusal("in"), "--bin-layout xy: give a letter")) << refusal("in");
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
  EXPECT_TRUE(hasLine(convert().warnings, "preprocess.deskew=none"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(3U, frames.size());
  EXPECT_TRUE(samePoints(someScan(3, 13), frames[0].scan));
  EXPECT_TRUE(samePoints(someScan(7, 17), frames[2].scan));
  EXPECT_NEAR(0.2, frames[1].scan.stamp - frames[0].scan.stamp, 1e-6);
  options.every_n = 1;
  EXPECT_FALSE(hasLine(convert().warnings, "preprocess.deskew=none"));
  EXPECT_EQ(5U, convert().scans);
  options.start = 1;
  options.end = 0;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convert(); }),
                       "--start and --end leave none of the 10 scans"));
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
  std::string waymo;  // x y z intensity elongation time, with coordinates above 0
  for (int point = 0; point < 12; ++point)
  {
    const std::array<float, 6> row{1.0F + static_cast<float>(point), 2, 1, 0.5F, 0.1F, 1.5e15F};
    waymo.append(reinterpret_cast<const char*>(row.data()), sizeof row);
  }
  folder.write("six/1.bin", waymo);
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
  EXPECT_TRUE(isWarned("six"));
  EXPECT_FALSE(isWarned("four"));
}

/** In millimetres the points of a lidar may have larger numbers than any coordinate in metres. */
TEST(ScanConverter, FarPointsInMillimetres)
{
  const TestFolder folder;
  const std::string points = "9000 1500 -800\n150000 -2500 4000\n";
  folder.write("pcd/0.pcd",
               "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n" + points);
  folder.write("ply/0.ply",
               "ply\nformat ascii 1.0\nelement vertex 2\nproperty int x\nproperty int y\nproperty "
               "int z\nend_header\n" +
                   points);
  for (const std::string input : {"pcd", "ply"})
  {
    ScanConverterOptions options;
    const auto convert = [&]
    { return convertScans(folder.file(input), folder.file("x.rawlog"), options); };
    const std::string message = messageOfError<UserError>([&] { (void)convert(); });
    EXPECT_TRUE(contains(message, "has a point at 150000.000000 m")) << message;
    EXPECT_TRUE(contains(message, "--scale, 0.001: millimetres")) << message;
    options.scale = 0.001;
    EXPECT_EQ(2U, convert().points);
    const auto frames = readAll(folder.file("x.rawlog"));
    ASSERT_EQ(2U, frames.at(0).scan.size());
    EXPECT_TRUE(frames[0].scan.points[1].isApprox(Eigen::Vector3f(150, -2.5F, 4), 1e-6F));
  }
}

/** No lidar measures whole metres. */
TEST(ScanConverter, CoordinatesThatAreWholeNumbers)
{
  const TestFolder folder;
  const auto isWarned = [&folder](float unit, std::size_t points, double scale = 1)
  {
    std::vector<Eigen::Vector3f> in_metres;
    for (std::size_t i = 0; i < points; ++i)
    {
      const auto k = static_cast<float>(i);
      in_metres.emplace_back(2 + 0.002F * k, 1.37F, -0.004F * k);
    }
    for (Eigen::Vector3f& point : in_metres)
    {
      point = (unit * point).array().round();
      point /= unit < 100 ? unit : 1;  // of a grid in metres
    }
    makeFolderOf(folder, "scans");
    writeCloud(folder.file("scans/0.bin"), in_metres, std::vector<float>(points, 0.5F));
    ScanConverterOptions options;
    options.scale = scale;
    const auto warnings =
        convertScans(folder.file("scans"), folder.file("x.rawlog"), options).warnings;
    return hasLine(warnings,
                   "0.bin: its coordinates are whole numbers: they are probably in millimetres "
                   "(--scale 0.001) or in centimetres (--scale 0.01)");
  };
  EXPECT_TRUE(isWarned(100, 2000));
  EXPECT_FALSE(isWarned(100, 100)) << "few points";
  EXPECT_FALSE(isWarned(100, 2000, 0.01)) << "the unit is given";
  EXPECT_FALSE(isWarned(10, 2000)) << "metres on a grid of 0.1 m";
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
                       "its columns are probably not x y z intensity (float32), or not relative to "
                       "the lidar; --bin-layout names its columns"));
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
  const std::string capture = folder.write("captures/a.pcap", "");
  EXPECT_TRUE(contains(message(folder.file("captures")), "; give its capture " + capture));
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

TEST(ScanConverter, AnErrorOfTheTruthLeavesAnEarlierRecording)
{
  const TestFolder folder;
  writeBins(folder, "in", 3);
  writeKittiPoses(folder.file("poses.txt"),
                  std::vector<Pose>{somePose(0), somePose(1), somePose(2)});
  ScanConverterOptions options;
  options.poses = folder.file("poses.txt");
  (void)convertScans(folder.file("in"), folder.file("x.rawlog"), options);
  const std::string earlier = folder.read("x.rawlog");
  const std::string earlier_truth = folder.read("x.gt/poses_tum.txt");
  const auto block = [&](double, std::size_t scans)
  {
    if (scans == 1)
    {
      folder.write("x.gt.tmp/poses_tum.txt/a", "no file can replace this folder");
    }
  };
  options.skip_first_n = 1;
  EXPECT_THROW((void)convertScans(folder.file("in"), folder.file("x.rawlog"), options, block),
               UserError);
  EXPECT_EQ(earlier, folder.read("x.rawlog"));
  EXPECT_EQ(earlier_truth, folder.read("x.gt/poses_tum.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog.tmp")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.gt.tmp")));
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
