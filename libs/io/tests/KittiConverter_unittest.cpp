// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/RawlogSource.h>

#include <cmath>
#include <stdexcept>

#include "KittiFolders.h"

namespace dyslam
{
TEST(KittiConverter, PlainOdometryWithEverything)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 4);
  folder.write("in/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("in/times.txt", "0\n0.1\n0.21\n0.33\n");
  // Camera 0 drives along its z.
  folder.write("in/poses.txt",
               "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  writeLabels((makeFolderOf(folder, "in/labels"), folder.file("in/labels/000002.label")),
              std::vector<Label>(12, 252));
  const auto result =
      convertKitti(folder.file("in"), folder.file("x.rawlog"), KittiConverterOptions{});
  EXPECT_EQ(4U, result.scans);
  EXPECT_EQ(10U + 11 + 12 + 13, result.points);
  EXPECT_EQ(3U, result.poses);
  EXPECT_EQ(1U, result.label_files);
  EXPECT_EQ(folder.file("x.gt"), result.ground_truth);
  EXPECT_EQ(2U, result.warnings.size());  // labels and poses lack scans

  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(4U, frames.size());
  EXPECT_TRUE(samePoints(someScan(3, 13), frames[3].scan));
  EXPECT_EQ(someScan(3, 13).intensity, frames[3].scan.intensity);
  EXPECT_EQ(0.21, frames[2].scan.stamp);
  ASSERT_TRUE(frames[2].T_world_vehicle_truth);
  EXPECT_TRUE(frames[2].T_world_vehicle_truth->isApprox(poseFromYpr(2, 0, 0, 0, 0, 0), 1e-9));
  EXPECT_FALSE(frames[3].T_world_vehicle_truth);
  EXPECT_EQ(3U, readTum(folder.file("x.gt/poses_tum.txt")).size());
  EXPECT_EQ(252U, trueLabels(folder.file("x.gt"), 2, 12).value().front());
}

TEST(KittiConverter, DeskewedScansWereSeenAtOneInstant)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 2);
  const auto times = [&](KittiKind kind, ScansDeskewed deskewed)
  {
    KittiConverterOptions options;
    options.kind = kind;
    options.deskewed = deskewed;
    (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
    return readAll(folder.file("x.rawlog")).at(1).scan.time;
  };
  // Without times of its own, a scan is deskewed by azimuth.
  EXPECT_EQ(times(KittiKind::odometry, ScansDeskewed::automatic), std::vector<float>(11, 0.F));
  EXPECT_EQ(times(KittiKind::raw, ScansDeskewed::yes), std::vector<float>(11, 0.F));
  EXPECT_TRUE(times(KittiKind::raw, ScansDeskewed::automatic).empty());
  EXPECT_TRUE(times(KittiKind::odometry, ScansDeskewed::no).empty());
}

TEST(KittiConverter, OfficialRaw)
{
  const TestFolder folder;
  const std::string drive = writeRawDrive(folder);
  folder.write("2011_09_26/calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n");
  folder.write("2011_09_26/calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n");
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  KittiConverterOptions options;
  options.kind = KittiKind::raw;
  const auto result = convertKitti(folder.file(drive), folder.file("x.rawlog"), options);
  EXPECT_EQ(2U, result.scans);
  EXPECT_EQ(2U, result.poses);
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(1317042145.9511993, frames.at(0).scan.stamp, 1e-6);
  EXPECT_NEAR(0.1038987, frames.at(1).scan.stamp - frames[0].scan.stamp, 1e-6);
}

/** KITTI has an empty line in timestamps.txt for each scan that it lost. */
TEST(KittiConverter, LostScansOfARawDrive)
{
  const TestFolder folder;
  const std::string points = "drive_sync/velodyne_points/";
  const std::string scans = points + "data";
  writeBins(folder, scans, 6, 10);
  const auto time = [](const char* seconds)
  { return "2011-09-26 13:02:" + std::string(seconds) + "\n"; };
  folder.write(points + "timestamps.txt",
               time("25.0") + "\n" + time("25.2") + time("25.3") + time("25.4") + time("25.5"));
  KittiConverterOptions options;
  options.kind = KittiKind::raw;
  const auto convert = [&]
  { return convertKitti(folder.file("drive_sync"), folder.file("x.rawlog"), options); };
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convert(); }),
                       "an empty line instead of a time for scan 1"));
  std::filesystem::remove(folder.file(scans + "/0000000001.bin"));
  EXPECT_EQ(5U, convert().scans);
  const auto frames = readAll(folder.file("x.rawlog"));
  const std::vector<double> expected{0, 0.2, 0.3, 0.4, 0.5};
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    EXPECT_NEAR(expected[i], frames.at(i).scan.stamp - frames[0].scan.stamp, 1e-6);
    EXPECT_EQ(i == 0 ? 10U : 11 + i, frames[i].scan.size());
  }
  options.end = 0.35;
  EXPECT_EQ(3U, convert().scans);
  std::filesystem::remove(folder.file(points + "timestamps.txt"));
  EXPECT_TRUE(contains(convert().warnings.at(0), "no velodyne_points/timestamps.txt or times.txt"));
}

TEST(KittiConverter, VerticalAngleCorrection)
{
  const TestFolder folder;
  makeFolderOf(folder, "in/velodyne");
  writeBin(folder.file("in/velodyne/000000.bin"), {{20, 0, 0}, {0, -5, -1}, {0, 0, 0}, {0, 0, 3}},
           {0, 0, 0, 0});
  KittiConverterOptions options;
  options.vertical_angle_correction = true;
  convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  const auto points = readAll(folder.file("x.rawlog")).at(0).scan.points;
  const double angle = 0.205 * M_PI / 180;
  EXPECT_NEAR(20 * std::sin(angle), points[0].z(), 1e-5);
  EXPECT_NEAR(20 * std::cos(angle), points[0].x(), 1e-5);
  EXPECT_NEAR(std::atan2(-1, 5) + angle, std::atan2(points[1].z(), -points[1].y()), 1e-6);
  EXPECT_NEAR(0, points[1].x(), 1e-6);
  EXPECT_EQ(Eigen::Vector3f(0, 0, 0), points[2]);
  EXPECT_EQ(Eigen::Vector3f(0, 0, 3), points[3]);
}

TEST(KittiConverter, ARangeOfTimeAndEveryNthScan)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 8);
  folder.write("in/times.txt", "5\n5.1\n5.2\n5.3\n5.4\n5.5\n5.6\n5.7\n");
  writeLabels((makeFolderOf(folder, "in/labels"), folder.file("in/labels/000004.label")),
              std::vector<Label>(14, 252));
  KittiConverterOptions options;
  options.start = 0.2;
  options.end = 0.7;
  options.every_n = 2;
  const auto convert = [&]
  { return convertKitti(folder.file("in"), folder.file("x.rawlog"), options); };
  std::size_t stated = 0;
  EXPECT_EQ(3U, convertKitti(folder.file("in"), folder.file("x.rawlog"), options,
                             [&stated](double, std::size_t scans) { stated = scans; })
                    .scans);
  EXPECT_EQ(3U, stated);
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(3U, frames.size());
  EXPECT_NEAR(5.2, frames[0].scan.stamp, 1e-9);
  EXPECT_NEAR(5.6, frames[2].scan.stamp, 1e-9);
  EXPECT_TRUE(samePoints(someScan(4, 14), frames[1].scan));
  EXPECT_TRUE(trueLabels(folder.file("x.gt"), 1, 14));
  EXPECT_TRUE(convert().warnings.size() == 1 && contains(convert().warnings[0], "labels for 1"))
      << "KITTI odometry's scans are deskewed";
  options.deskewed = ScansDeskewed::no;
  EXPECT_TRUE(contains(convert().warnings.back(), "preprocess.deskew=none"));
  options.start = 0.75;
  options.end = 0;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convert(); }), "leave none"));
  options.end = 0.5;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convert(); }), "is not after start"));
}

TEST(KittiConverter, TooLargeFrameNumbersAreRefused)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 1);
  const auto rename = [&folder](const char* from, const char* to)
  {
    std::filesystem::rename(folder.file(std::string("in/velodyne/") + from),
                            folder.file(std::string("in/velodyne/") + to));
  };
  const auto convert = [&folder]
  { return convertKitti(folder.file("in"), folder.file("x.rawlog"), {}); };
  rename("000000.bin", "2147483647.bin");
  EXPECT_EQ(1U, convert().scans);
  rename("2147483647.bin", "4294967296.bin");  // 0 in 32 bits
  const auto message = messageOfError<UserError>([&] { (void)convert(); });
  EXPECT_TRUE(contains(message, "4294967296.bin: the number in its name is too large")) << message;
}

TEST(KittiConverter, OtherColumnsAreRefused)
{
  const TestFolder folder;
  folder.write("in/velodyne/000000.bin", fiveColumns(0));
  EXPECT_TRUE(
      contains(messageOfError<UserError>(
                   [&] { (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), {}); }),
               "scans2rawlog"));
}

TEST(KittiConverter, Errors)
{
  const TestFolder folder;
  KittiConverterOptions options;
  const auto message = [&]
  {
    return messageOfError<UserError>(
        [&] { convertKitti(folder.file("in"), folder.file("x.rawlog"), options); });
  };
  EXPECT_TRUE(contains(message(), "no such folder"));
  makeFolderOf(folder, "in/velodyne");
  EXPECT_TRUE(contains(message(), "has no scans"));
  writeBins(folder, "in/velodyne", 2);
  options.poses = folder.file("none.txt");
  EXPECT_TRUE(contains(message(), "none.txt: no such file"));
  options.poses = folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_TRUE(contains(message(), "--calib"));
  options.poses = "";
  options.oxts = folder.write("oxts.txt", oxtsLine(0));
  EXPECT_TRUE(contains(message(), "--calib"));
  options.oxts = "";
  writeBins(folder, "gaps/velodyne", 3);
  std::filesystem::rename(folder.file("gaps/velodyne/000002.bin"),
                          folder.file("gaps/velodyne/000005.bin"));
  options.pose_frame = PoseFrame::lidar;
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  options.poses = folder.write("four.txt", identity + identity + identity + identity);
  EXPECT_TRUE(
      contains(messageOfError<UserError>(
                   [&] { convertKitti(folder.file("gaps"), folder.file("y.rawlog"), options); }),
               "has 4 poses, but there are 3 scans, numbered from 0 to 5; a pose for each scan"));
  options.poses = "";
  folder.write("in/labels/000000.label", std::string(4 * 9, '\0'));
  EXPECT_TRUE(contains(message(), "has 9 labels, but the scan has 10 points"));
  folder.write("in/velodyne/000001.bin", "cut");
  std::filesystem::remove(folder.file("in/labels/000000.label"));
  EXPECT_TRUE(contains(message(), "000001.bin"));
  // The scan before the bad one is kept in a file that is whole.
  EXPECT_EQ(1U, readAll(folder.file("x.rawlog")).size());
}

TEST(KittiConverter, AWrongKindIsNoticedAndTheRightOneNamed)
{
  const TestFolder folder;
  writeBins(folder, "day/day_drive_0001_sync/velodyne_points/data", 1);
  writeBins(folder, "object/training/velodyne/0003", 1);
  writeBins(folder, "dataset/sequences/07/velodyne", 1);
  const auto message = [&](const std::string& input, KittiKind kind)
  {
    KittiConverterOptions options;
    options.kind = kind;
    return messageOfError<UserError>(
        [&] { (void)convertKitti(folder.file(input), folder.file("x.rawlog"), options); });
  };
  const std::string drive = "day/day_drive_0001_sync";
  EXPECT_TRUE(contains(message(drive, KittiKind::odometry), "use --kind raw"));
  EXPECT_TRUE(contains(message("object/training", KittiKind::raw), "use --kind tracking"));
  EXPECT_TRUE(contains(message("dataset/sequences/07", KittiKind::raw), "use --kind odometry"));
  EXPECT_TRUE(contains(message("dataset", KittiKind::odometry), "dataset/sequences/07"));
  EXPECT_TRUE(contains(message("day", KittiKind::raw), drive));
  EXPECT_TRUE(contains(message("object", KittiKind::tracking), "object/training"));
}

TEST(KittiConverter, AFolderIsGivenFromItsParent)
{
  const TestFolder folder;
  writeBins(folder, "dataset/sequences/07/velodyne", 2);
  folder.write("dataset/sequences/07/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("dataset/poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 3\n");
  const WorkingFolder within(folder.file("dataset/sequences"));
  KittiConverterOptions options;
  options.kind = KittiKind::raw;
  const auto message = messageOfError<UserError>(
      [&] { (void)convertKitti("07", folder.file("x.rawlog"), options); });
  const auto result = convertKitti("07", folder.file("x.rawlog"), {});
  EXPECT_EQ("07: has the layout of KITTI odometry; use --kind odometry", message);
  EXPECT_EQ(2U, result.poses);
  EXPECT_EQ("../poses/07.txt", result.pose_source);

  (void)writeRawDrive(folder);
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  const WorkingFolder day(folder.file("2011_09_26"));
  EXPECT_EQ(2U, convertKitti("2011_09_26_drive_0001_sync", folder.file("x.rawlog"), options).poses);
}

TEST(KittiConverter, TimesAndSensorPose)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 2);
  KittiConverterOptions options;
  options.times = folder.write("t.txt", "10\n10.5\n");
  options.sensor_pose = "0 0 1.73 90 0 0";
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(result.warnings.empty());
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(10.5, frames.at(1).scan.stamp, 1e-9);
  EXPECT_TRUE(
      frames[0].scan.T_vehicle_lidar.isApprox(poseFromYpr(0, 0, 1.73, M_PI / 2, 0, 0), 1e-9));
  options.times = "";
  EXPECT_TRUE(contains(
      convertKitti(folder.file("in"), folder.file("x.rawlog"), options).warnings.at(0), "0.1034"));
}

TEST(KittiConverter, AFileWithoutTimesIsAnError)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 2);
  KittiConverterOptions options;
  options.times = folder.write("t.txt", "# none yet\n");
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options); }),
      "t.txt: has 0 times, none for scan 0"));
}

TEST(Conversions, AnInterruptedOneLeavesWhatWasThere)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 4);
  folder.write("in/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("in/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n");
  KittiConverterOptions options;
  (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  const std::string rawlog = folder.read("x.rawlog");
  const std::string poses = folder.read("x.gt/poses_tum.txt");
  ASSERT_FALSE(poses.empty());
  options.dt = 5;
  options.external_storage = true;
  const auto stop = [](double, std::size_t scans)
  {
    if (scans == 2)
    {
      throw std::runtime_error("stop");
    }
  };
  EXPECT_THROW((void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options, stop),
               std::runtime_error);
  EXPECT_EQ(rawlog, folder.read("x.rawlog"));
  EXPECT_EQ(poses, folder.read("x.gt/poses_tum.txt"));
  for (const char* leftover : {"x.rawlog.tmp", "x.gt.tmp", "x_Images"})
  {
    EXPECT_FALSE(std::filesystem::exists(folder.file(leftover))) << leftover;
  }
}

TEST(KittiConverter, RealDriveKeepsEveryPoint)
{
  DYSLAM_REQUIRE_DATA();
  const TestFolder folder;
  const std::string input = *realDataFolder() + "/kitti_raw_2011_09_26_drive_0005";
  KittiConverterOptions options;
  options.kind = KittiKind::raw;
  options.poses = input + "/poses_icp_deskewed_velo.txt";
  options.skip_first_n = 30;
  options.only_first_n = 3;
  const auto result = convertKitti(input, folder.file("x.rawlog"), options);
  EXPECT_EQ(3U, result.label_files);
  EXPECT_GT(result.boxes, 0U);
  const auto poses = readKittiPoses(options.poses);
  for (const Frame& frame : readAll(folder.file("x.rawlog")))
  {
    const std::string name = number(30 + frame.index, 6);
    const Scan scan = readBin(input + "/velodyne/" + name + ".bin");
    EXPECT_TRUE(samePoints(scan, frame.scan));
    EXPECT_EQ(scan.intensity, frame.scan.intensity);
    EXPECT_TRUE(frame.T_world_vehicle_truth->isApprox(poses[30 + frame.index], 1e-9));
    EXPECT_EQ(readLabels(input + "/labels/" + name + ".label"),
              trueLabels(folder.file("x.gt"), frame.index, scan.size()));
  }
}
}  // namespace dyslam
