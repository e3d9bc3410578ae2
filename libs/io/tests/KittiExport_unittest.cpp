// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/KittiExport.h>
#include <dyslam/io/RawlogSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** Four scans with truth, rings and the labels of two. */
void writeRecording(const TestFolder& folder)
{
  RawlogWriter writer(folder.file("x.rawlog"));
  GroundTruthWriter truth(folder.file("x.gt"));
  for (std::size_t i = 0; i < 4; ++i)
  {
    Scan scan = someScan(i, 50 + i);
    scan.ring.assign(scan.size(), static_cast<std::uint16_t>(i));
    writer.write(scan, somePose(i));
    if (i >= 2)
    {
      truth.addLabels(i, std::vector<Label>(50 + i, static_cast<Label>(250 + i)));
    }
  }
  writer.close();
  truth.close();
}

Pose lidarPose(std::size_t i)
{
  return somePose(i) * someScan(i, 1).T_vehicle_lidar;
}
}  // namespace

TEST(KittiExport, ThereAndBackAgain)
{
  const TestFolder folder;
  writeRecording(folder);
  KittiExportOptions options;
  options.rings = true;
  const auto there = exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options);
  EXPECT_EQ(4U, there.scans);
  EXPECT_EQ(4U, there.poses);
  EXPECT_EQ(2U, there.label_files);
  EXPECT_TRUE(there.warnings.empty());
  EXPECT_EQ(folder.read("kitti/sequences/00/poses.txt"), folder.read("kitti/poses/00.txt"));

  KittiConverterOptions back;
  back.deskewed = ScansDeskewed::no;
  const auto result =
      convertKitti(folder.file("kitti/sequences/00"), folder.file("y.rawlog"), back);
  EXPECT_EQ(4U, result.poses);
  EXPECT_EQ(2U, result.label_files);
  const auto before = readAll(folder.file("x.rawlog"));
  const auto after = readAll(folder.file("y.rawlog"));
  ASSERT_EQ(4U, after.size());
  for (std::size_t i = 0; i < 4; ++i)
  {
    EXPECT_TRUE(samePoints(before[i].scan, after[i].scan));
    EXPECT_EQ(before[i].scan.intensity, after[i].scan.intensity);
    EXPECT_EQ(before[i].scan.ring, after[i].scan.ring);
    EXPECT_NEAR(before[i].scan.stamp - before[0].scan.stamp, after[i].scan.stamp, 1e-6);
    // KITTI's world is the first scan's own frame.
    EXPECT_TRUE(
        after[i].T_world_vehicle_truth->isApprox(lidarPose(0).inverse() * lidarPose(i), 1e-6));
    const auto labels = trueLabels(folder.file("y.gt"), i, 50 + i);
    EXPECT_EQ(i >= 2, labels.has_value());
    EXPECT_TRUE(!labels || labels->back() == 250 + i);
  }
}

TEST(KittiExport, ScansOfFurtherLidarsAreMerged)
{
  const TestFolder folder;
  Scan rear = someScan(0, 5);
  rear.sensor_label = "rear";
  rear.T_vehicle_lidar = poseFromYpr(-1, 0, 1, M_PI, 0, 0);
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    GroundTruthWriter truth(folder.file("x.gt"));
    for (std::size_t i = 0; i < 2; ++i)
    {
      rear.stamp = someScan(i, 1).stamp + 0.02;
      writer.write(rear);  // before that of the first lidar
      writer.write(someScan(i, 10), somePose(i));
      truth.addLabels(i, std::vector<Label>(15, 252));
    }
    writer.close();
    truth.close();
  }
  KittiExportOptions options;
  options.further_lidars = "rear";
  const auto result = exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options);
  EXPECT_EQ(2U, result.scans);
  EXPECT_EQ(30U, result.points);
  EXPECT_EQ(2U, result.poses);
  EXPECT_EQ(2U, result.label_files);
  EXPECT_TRUE(result.warnings.empty());
  const Scan written = readCloud(folder.file("kitti/sequences/00/velodyne/000001.bin"));
  ASSERT_EQ(15U, written.size());
  const Pose T_front_rear = someScan(0, 1).T_vehicle_lidar.inverse() * rear.T_vehicle_lidar;
  EXPECT_TRUE(written.points[12].isApprox(
      (T_front_rear * rear.points[2].cast<double>()).cast<float>(), 1e-5F));

  options.rings = true;
  options.sequence = "01";
  const auto message = messageOfError<UserError>(
      [&] { (void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options); });
  EXPECT_TRUE(contains(message, "--rings")) << message;
}

TEST(KittiExport, OptionsWithoutAnEffectAreSaid)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < 3; ++i)
    {
      writer.write(someScan(i, 10));
      poses.push_back(somePose(i));
    }
    writer.close();
    poses.push_back(somePose(3));
    writeKittiPoses(folder.file("four.txt"), poses);
  }
  KittiExportOptions options;
  options.rings = true;
  options.trajectory = folder.file("four.txt");
  const auto result = exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options);
  EXPECT_EQ(3U, result.poses);
  ASSERT_EQ(2U, result.warnings.size());
  EXPECT_TRUE(contains(result.warnings[0], "four.txt: has 4 poses for 3 scans"));
  EXPECT_TRUE(contains(result.warnings[1], "--rings: 0 of 3 scans have ring numbers"));

  options.sequence = "01";
  options.rings = false;
  options.only_first_n = 3;
  EXPECT_TRUE(exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options).warnings.empty());
  options.rings = options.no_scans = true;
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] { (void)exportKitti(folder.file("x.rawlog"), "never", options); }),
                       "--rings: are written beside the scans"));
}

TEST(KittiExport, ScansThatAreNotDeskewedAreNoted)
{
  const TestFolder folder;
  const auto notesOf = [&](float sweep, bool no_scans)
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    for (std::size_t i = 0; i < 2; ++i)
    {
      Scan scan = someScan(i, 3);
      scan.time = {0, sweep, std::nanf("")};
      writer.write(scan, somePose(i));
    }
    writer.close();
    KittiExportOptions options;
    options.no_scans = no_scans;
    std::filesystem::remove_all(folder.file("kitti"));
    return exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options).notes;
  };
  EXPECT_TRUE(notesOf(0, false).empty()) << "deskewed to one time";
  EXPECT_TRUE(notesOf(0.1F, true).empty());
  const auto notes = notesOf(0.1F, false);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(contains(notes[0], "not deskewed as those of KITTI odometry")) << notes[0];
}

TEST(KittiExport, TimesOfThePointsComeBackAndCountUnlessTheScansAreSaidToBeDeskewed)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    for (std::size_t i = 0; i < 2; ++i)
    {
      Scan scan = someScan(i, 3);
      scan.time = {-0.05F, 0.03F * static_cast<float>(i + 1), std::nanf("")};
      writer.write(scan, somePose(i));
    }
    writer.close();
  }
  (void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), {});
  const auto timesBack = [&](ScansDeskewed deskewed)
  {
    KittiConverterOptions options;
    options.deskewed = deskewed;
    const auto result =
        convertKitti(folder.file("kitti/sequences/00"), folder.file("y.rawlog"), options);
    const bool of_file = std::any_of(result.notes.begin(), result.notes.end(),
                                     [](const std::string& note)
                                     { return contains(note, "the times of point_times"); });
    EXPECT_EQ(deskewed != ScansDeskewed::yes, of_file);
    return readAll(folder.file("y.rawlog")).at(1).scan.time;
  };
  for (const ScansDeskewed deskewed : {ScansDeskewed::automatic, ScansDeskewed::no})
  {
    const std::vector<float> times = timesBack(deskewed);
    ASSERT_EQ(3U, times.size());
    EXPECT_EQ(-0.05F, times[0]);
    EXPECT_EQ(0.06F, times[1]);
    EXPECT_TRUE(std::isnan(times[2]));
  }
  EXPECT_EQ(std::vector<float>(3, 0.F), timesBack(ScansDeskewed::yes));

  std::filesystem::remove(folder.file("kitti/sequences/00/point_times/000000.time"));
  KittiConverterOptions options;
  const auto warnings = [&]
  {
    return convertKitti(folder.file("kitti/sequences/00"), folder.file("y.rawlog"), options)
        .warnings;
  };
  EXPECT_TRUE(contains(warnings().at(0), "point times for 1 of 2 scans"));
  options.deskewed = ScansDeskewed::yes;
  EXPECT_TRUE(warnings().empty()) << "the times are not used";
}

TEST(KittiExport, DeskewedScansNeedAPoseAndHaveNoTimes)
{
  const TestFolder folder;
  const auto write = [&](bool with_poses, float sweep)
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    for (std::size_t i = 0; i < 2; ++i)
    {
      Scan scan = someScan(i, 2);
      if (sweep > 0)
      {
        scan.time = {0, sweep};
      }
      writer.write(scan, with_poses ? std::optional<Pose>(somePose(i)) : std::nullopt);
    }
    writer.close();
  };
  KittiExportOptions options;
  options.deskew = true;
  write(true, 0.1F);
  const auto result = exportKitti(folder.file("x.rawlog"), folder.file("a"), options);
  EXPECT_TRUE(result.notes.empty() && result.warnings.empty());
  EXPECT_FALSE(std::filesystem::exists(folder.file("a/sequences/00/point_times")));
  const Scan written = readCloud(folder.file("a/sequences/00/velodyne/000001.bin"));
  EXPECT_EQ(someScan(1, 2).points[0], written.points[0]) << "measured at the stamp";
  EXPECT_GT((someScan(1, 2).points[1] - written.points[1]).norm(), 0.5F);

  write(true, 0);
  EXPECT_TRUE(
      contains(exportKitti(folder.file("x.rawlog"), folder.file("b"), options).warnings.at(0),
               "the points of 2 of 2 scans have no times"));
  write(false, 0.1F);
  EXPECT_TRUE(
      contains(messageOfError<UserError>(
                   [&] { (void)exportKitti(folder.file("x.rawlog"), folder.file("c"), options); }),
               "--deskew: scan 0 has no pose"));
  options.no_scans = true;
  EXPECT_TRUE(
      contains(messageOfError<UserError>(
                   [&] { (void)exportKitti(folder.file("x.rawlog"), folder.file("c"), options); }),
               "leave out --no-scans"));
}

TEST(KittiExport, TracksAreInTheCameraFrame)
{
  const TestFolder folder;
  writeRecording(folder);
  LabelledBox box;
  box.type = "Pedestrian";
  box.score = 0.5;
  box.box.size = {0.6, 0.7, 1.8};
  std::vector<LabelledBox> boxes;
  for (const int frame : {0, 2, 2, 3})
  {
    box.frame = frame;
    box.id = static_cast<int>(boxes.size());
    box.box.centre = {10, 2.0 + frame, -0.5};
    box.box.yaw = 0.3;
    boxes.push_back(box);
  }
  writeTracks(folder.file("tracks.txt"), boxes);
  KittiExportOptions options;
  options.tracks = folder.file("tracks.txt");
  options.skip_first_n = 1;
  options.only_first_n = 2;
  EXPECT_TRUE(exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options).warnings.empty());
  const auto written = readKittiTracking(folder.file("kitti/tracks/00.txt"), cameraAxes(), true);
  ASSERT_EQ(2U, written.size());
  for (std::size_t i = 0; i < 2; ++i)
  {
    EXPECT_EQ(1, written[i].frame) << "the third scan is the second of the sequence";
    EXPECT_EQ(boxes[1 + i].id, written[i].id);
    EXPECT_EQ("Pedestrian", written[i].type);
    EXPECT_TRUE(written[i].box.centre.isApprox(boxes[1 + i].box.centre, 1e-5));
    EXPECT_NEAR(0.3, written[i].box.yaw, 1e-5);
  }
  options.sequence = "01";
  options.skip_first_n = 1;
  options.only_first_n = 1;
  const auto none = exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options);
  ASSERT_EQ(1U, none.warnings.size());
  EXPECT_TRUE(contains(none.warnings[0], "tracks.txt: has no box of these scans"));
}

TEST(KittiExport, DamagedTracksDoNotStopIt)
{
  const TestFolder folder;
  writeRecording(folder);
  folder.write("x.gt/tracks.txt", "no track\n");
  const auto result = exportKitti(folder.file("x.rawlog"), folder.file("kitti"), {});
  EXPECT_EQ(4U, result.scans);
  EXPECT_EQ(2U, result.label_files);
}

TEST(KittiExport, PosesAreThoseOfTheCamera)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("x.rawlog"));
    Trajectory given;
    for (std::size_t i = 0; i < 3; ++i)
    {
      Scan scan = someScan(i, 10);
      scan.T_vehicle_lidar = Pose::Identity();
      writer.write(scan);
      given.push_back(scan.stamp + 2e-4,
                      poseFromYpr(5 + 2.0 * double(i), 1.0 * double(i), 0, 0, 0, 0));
    }
    writer.close();
    writeTum(folder.file("t.txt"), given);
  }
  KittiExportOptions options;
  options.no_scans = true;
  const auto without = exportKitti(folder.file("x.rawlog"), folder.file("a"), options);
  EXPECT_EQ(0U, without.poses);
  EXPECT_TRUE(contains(without.warnings.at(0), "0 of 3 scans"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a/sequences/00/velodyne")));
  options.trajectory = folder.file("t.txt");
  options.sequence = "07";
  EXPECT_EQ(3U, exportKitti(folder.file("x.rawlog"), folder.file("a"), options).poses);
  const auto poses = readKittiPoses(folder.file("a/poses/07.txt"));
  ASSERT_EQ(3U, poses.size());
  EXPECT_TRUE(poses[0].isApprox(Pose::Identity(), 1e-9));
  EXPECT_TRUE(poses[2].translation().isApprox(Eigen::Vector3d(-2, 0, 4), 1e-9));
}

TEST(KittiExport, EveryCalibrationBecomesOneOfOdometry)
{
  const TestFolder folder;
  writeRecording(folder);
  const std::string rows = "0 -1 0 0.05 0 0 -1 -0.1 1 0 0 -0.3\n";
  const std::string projection = "7 0 6 4 0 7 1 0.2 0 0 1 0\n";
  const std::string odometry = folder.write("o.txt", "P2: " + projection + "Tr: " + rows);
  const std::string tracking =
      folder.write("t.txt", "P2: " + projection + "R_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam " + rows +
                                "Tr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n");
  folder.write("raw/calib_cam_to_cam.txt",
               "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: " + projection);
  const std::string raw =
      folder.write("raw/calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0.05 -0.1 -0.3\n");
  KittiExportOptions options;
  options.no_scans = true;
  const KittiCalib expected = readKittiCalib(odometry);
  for (const std::string& calib : {odometry, tracking, raw, folder.file("raw")})
  {
    options.calib = calib;
    options.sequence += '0';
    EXPECT_EQ(4U, exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options).poses);
    const std::string written = "kitti/sequences/" + options.sequence + "/";
    const std::string text = folder.read(written + "calib.txt");
    EXPECT_TRUE(contains(text, "\nTr: ")) << text;
    const KittiCalib after = readKittiCalib(folder.file(written + "calib.txt"));
    EXPECT_TRUE(after.T_cam_velo.isApprox(expected.T_cam_velo, 1e-9)) << calib;
    EXPECT_TRUE(expected.P2 == after.P2) << calib;
  }
  EXPECT_EQ(folder.read("o.txt"), folder.read("kitti/sequences/000/calib.txt"));
  options.calib = folder.write("imu/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  options.sequence = "09";
  EXPECT_THROW((void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options),
               UserError);
}

TEST(KittiExport, PosesAloneAreForASubmission)
{
  const TestFolder folder;
  writeRecording(folder);
  KittiExportOptions options;
  (void)exportKitti(folder.file("x.rawlog"), folder.file("whole"), options);
  options.poses_only = true;
  const auto result = exportKitti(folder.file("x.rawlog"), folder.file("poses"), options);
  EXPECT_EQ(4U, result.poses);
  EXPECT_TRUE(result.notes.empty());
  EXPECT_EQ(folder.read("whole/poses/00.txt"), folder.read("poses/poses/00.txt"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("poses/sequences")));
  Trajectory three;
  for (std::size_t i = 0; i < 3; ++i)
  {
    three.push_back(someScan(i, 1).stamp, somePose(i));
  }
  writeTum(folder.file("three.txt"), three);
  options.trajectory = folder.file("three.txt");
  options.sequence = "01";
  const auto message = [&]
  {
    return messageOfError<UserError>(
        [&] { (void)exportKitti(folder.file("x.rawlog"), folder.file("poses"), options); });
  };
  EXPECT_EQ(message(), "--poses-only: no poses are written: 3 of 4 scans have one");
  EXPECT_FALSE(std::filesystem::exists(folder.file("poses/poses/01.txt")));
  options.rings = true;
  EXPECT_TRUE(contains(message(), "leave out --no-scans, --rings and --tracks"));
}

TEST(KittiExport, AnEarlierExportIsReplacedIfForced)
{
  const TestFolder folder;
  writeRecording(folder);
  KittiExportOptions options;
  const auto convert = [&]
  { return exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options); };
  (void)convert();
  folder.write("kitti/sequences/00/velodyne/000009.bin", "of a longer recording");
  options.force = true;
  options.only_first_n = 2;
  EXPECT_EQ(2U, convert().poses);
  EXPECT_FALSE(std::filesystem::exists(folder.file("kitti/sequences/00/velodyne/000009.bin")));
  EXPECT_EQ(folder.read("kitti/sequences/00/poses.txt"), folder.read("kitti/poses/00.txt"));
  const auto message = [&] { return messageOfError<UserError>([&] { (void)convert(); }); };
  folder.write("kitti/sequences/00/image_2/000000.png", "someone's");
  EXPECT_TRUE(contains(message(), "has files of others (image_2)")) << message();
  EXPECT_EQ("someone's", folder.read("kitti/sequences/00/image_2/000000.png"));
  options.poses_only = true;
  options.only_first_n = 3;
  EXPECT_EQ(3U, convert().poses) << "touches poses/00.txt alone";
  EXPECT_NE(folder.read("kitti/sequences/00/poses.txt"), folder.read("kitti/poses/00.txt"));
}

TEST(KittiExport, AnOriginalSequenceIsNotReplacedEvenIfForced)
{
  const TestFolder folder;
  writeRecording(folder);
  folder.write("kitti/sequences/00/velodyne/000000.bin", "original");
  folder.write("kitti/sequences/00/calib.txt", "original");
  folder.write("kitti/poses/00.txt", "original");
  KittiExportOptions options;
  options.force = true;
  for (const bool poses_only : {false, true})
  {
    options.poses_only = poses_only;
    const std::string message = messageOfError<UserError>(
        [&] { (void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options); });
    EXPECT_TRUE(contains(message, "was not written by rawlog2kitti")) << message;
    for (const char* file :
         {"sequences/00/velodyne/000000.bin", "sequences/00/calib.txt", "poses/00.txt"})
    {
      EXPECT_EQ("original", folder.read(std::string("kitti/") + file)) << file;
    }
  }
}

TEST(KittiExport, ForceReplacesWhatIsOfTheEarlierExportAndNothingElse)
{
  const TestFolder folder;
  writeRecording(folder);
  KittiExportOptions options;
  options.force = true;
  const auto convert = [&]
  { return exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options); };
  (void)convert();
  folder.write("kitti/tracks/00.txt", "of others");
  // Without poses those of the earlier export go, too.
  folder.write("short.txt", "100 0 0 0 0 0 0 1\n");
  options.trajectory = folder.file("short.txt");
  EXPECT_EQ(0U, convert().poses);
  EXPECT_FALSE(std::filesystem::exists(folder.file("kitti/poses/00.txt")));
  EXPECT_EQ("of others", folder.read("kitti/tracks/00.txt"));
  // Those of others stay.
  folder.write("kitti/poses/00.txt", "of others");
  EXPECT_EQ(0U, convert().poses);
  EXPECT_EQ("of others", folder.read("kitti/poses/00.txt"));
}

TEST(KittiExport, AnErrorAtTheEndKeepsTheEarlierExport)
{
  const TestFolder folder;
  writeRecording(folder);
  KittiExportOptions options;
  options.force = true;
  const auto convert = [&]
  { return exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options); };
  (void)convert();
  const std::string before = folder.read("kitti/sequences/00/velodyne/000002.bin");
  folder.write("kitti/tracks", "is no folder");
  folder.write("boxes.txt", "");
  options.tracks = folder.file("boxes.txt");
  options.only_first_n = 1;
  EXPECT_THROW((void)convert(), UserError);
  EXPECT_EQ(before, folder.read("kitti/sequences/00/velodyne/000002.bin"));
  EXPECT_TRUE(std::filesystem::exists(folder.file("kitti/poses/00.txt")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("kitti/sequences/00.tmp")));
}

TEST(KittiExport, NothingOfOthersIsTouchedAndNothingHalfStays)
{
  const TestFolder folder;
  writeRecording(folder);
  folder.write("kitti/sequences/00/velodyne/000000.bin", "someone's");
  KittiExportOptions options;
  const auto message = messageOfError<UserError>(
      [&] { (void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options); });
  EXPECT_TRUE(contains(message, "is there already")) << message;
  EXPECT_EQ("someone's", folder.read("kitti/sequences/00/velodyne/000000.bin"));
  options.sequence = "02";
  folder.write("kitti/poses/02.txt", "someone's");
  EXPECT_THROW((void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options),
               UserError);
  EXPECT_EQ("someone's", folder.read("kitti/poses/02.txt"));
  options.sequence = "01";
  const auto stop = [](double, std::size_t scans)
  {
    if (scans == 2)
    {
      throw std::runtime_error("stop");
    }
  };
  EXPECT_THROW((void)exportKitti(folder.file("x.rawlog"), folder.file("kitti"), options, stop),
               std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder.file("kitti/sequences/01")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("kitti/sequences/01.tmp")));
}
}  // namespace dyslam
