// SPDX-License-Identifier: BSD-3-Clause
// True poses, labels and boxes of KITTI recordings.
#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/KittiConverter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "KittiFolders.h"

namespace dyslam
{
namespace
{
/** Of one frame of x.rawlog. */
std::vector<LabelledBox> trueBoxes(const TestFolder& folder, int frame)
{
  std::vector<LabelledBox> boxes = readTracks(folder.file("x.gt/tracks.txt"));
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(),
                             [frame](const LabelledBox& box) { return box.frame != frame; }),
              boxes.end());
  return boxes;
}
}  // namespace

TEST(KittiTruth, OfficialOdometryFindsPosesOfItsSequence)
{
  const TestFolder folder;
  writeBins(folder, "dataset/sequences/07/velodyne", 2);
  folder.write("dataset/sequences/07/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("dataset/poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 3\n");
  KittiConverterOptions options;
  const auto result =
      convertKitti(folder.file("dataset/sequences/07/"), folder.file("x.rawlog"), options);
  EXPECT_EQ(2U, result.poses);
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(3, frames.at(1).T_world_vehicle_truth->translation().x(), 1e-9);
  EXPECT_NEAR(0.1034, frames.at(1).scan.stamp, 1e-9);
  EXPECT_TRUE(hasLine(result.notes, "KITTI's are of camera 0 (z ahead)"));
  EXPECT_FALSE(hasLine(result.notes, "no true poses"));

  std::filesystem::remove(folder.file("dataset/poses/07.txt"));
  const auto without =
      convertKitti(folder.file("dataset/sequences/07"), folder.file("x.rawlog"), options);
  EXPECT_EQ(0U, without.poses);
  EXPECT_TRUE(hasLine(without.notes, "no true poses: the recording has neither " +
                                         folder.file("dataset/sequences/07/poses.txt") + " nor " +
                                         folder.file("dataset/poses/07.txt")));
}

/** As of KITTI's development kit or another program: no folder `sequences` above. */
TEST(KittiTruth, PosesOfTheCameraInAPlainFolderAreNoted)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 2);
  folder.write("in/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const std::string poses = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 3\n";
  folder.write("in/poses.txt", poses);
  KittiConverterOptions options;
  const std::string note = "KITTI's are of camera 0 (z ahead)";
  const auto of_camera = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_EQ(2U, of_camera.poses);
  EXPECT_TRUE(hasLine(of_camera.notes, note));
  options.poses = folder.write("poses_velo.txt", poses);
  const auto of_lidar = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_EQ(2U, of_lidar.poses);
  EXPECT_FALSE(hasLine(of_lidar.notes, note));
}

TEST(KittiTruth, OfficialTrackingWithBoxesAndALostScan)
{
  const TestFolder folder;
  writeBins(folder, "training/velodyne/0001", 4);
  writeBins(folder, "training/velodyne/0002", 1);
  std::filesystem::remove(folder.file("training/velodyne/0001/000001.bin"));
  folder.write("training/calib/0001.txt", tracking_calib);
  folder.write("training/oxts/0001.txt", oxtsLine(0) + oxtsLine(1) + oxtsLine(2) + oxtsLine(3));
  const std::string box = " 5 Car 0 0 0 1 2 3 4 1.5 1.8 4 0 1 20 -1.5707963\n";
  folder.write("training/label_02/0001.txt",
               "-1" + box + "0" + box + "1" + box + "2" + box + "2" + box);
  KittiConverterOptions options;
  options.kind = KittiKind::tracking;
  const auto message = messageOfError<UserError>(
      [&] { convertKitti(folder.file("training"), folder.file("x.rawlog"), options); });
  EXPECT_TRUE(contains(message, "--sequence")) << message;

  options.sequence = "0001";
  options.dt = 0.1;
  const auto result = convertKitti(folder.file("training"), folder.file("x.rawlog"), options);
  EXPECT_EQ(3U, result.scans);
  EXPECT_EQ(3U, result.boxes);
  EXPECT_EQ(3U, result.poses);
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(0.2, frames.at(1).scan.stamp, 1e-9);
  EXPECT_EQ(12U, frames[1].scan.size());
  // Oxts text above has six decimals of a degree: 0.1 m.
  EXPECT_NEAR(2, frames[1].T_world_vehicle_truth->translation().x(), 0.2);
  EXPECT_EQ(1U, trueBoxes(folder, 0).size());
  ASSERT_EQ(2U, trueBoxes(folder, 1).size());
  EXPECT_TRUE(trueBoxes(folder, 1)[0].box.centre.isApprox(Eigen::Vector3d(20, 0, -0.25), 1e-6));
  EXPECT_TRUE(trueBoxes(folder, 2).empty());

  options.dt = 0;
  EXPECT_TRUE(
      hasLine(convertKitti(folder.file("training"), folder.file("x.rawlog"), options).warnings,
              "no " + folder.file("training/times/0001.txt") + ": 0.1034 s"));
  folder.write("training/times/0001.txt", "0\n0.3\n0.5\n0.75\n");
  (void)convertKitti(folder.file("training"), folder.file("x.rawlog"), options);
  EXPECT_NEAR(0.75, readAll(folder.file("x.rawlog")).at(2).scan.stamp, 1e-9) << "the lost one";
}

TEST(KittiTruth, LabelsBesideTheScans)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 3);
  for (const std::size_t i : {1U, 2U})
  {
    writeLabels(folder.file("in/velodyne/" + number(i, 6) + ".label"),
                std::vector<Label>(10 + i, static_cast<Label>(250 + i)));
  }
  const auto result =
      convertKitti(folder.file("in"), folder.file("x.rawlog"), KittiConverterOptions{});
  EXPECT_EQ(2U, result.label_files);
  EXPECT_FALSE(trueLabels(folder.file("x.gt"), 0, 10));
  EXPECT_EQ(252U, trueLabels(folder.file("x.gt"), 2, 12).value().front());
}

TEST(KittiTruth, SkipsAndLimitsRenumberTheTruth)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 5);
  folder.write("in/label_02.txt", "3 5 Car 0 0 0 1 2 3 4 1.5 1.8 4 0 1 20 0\n");
  folder.write("in/calib.txt", tracking_calib);
  KittiConverterOptions options;
  options.kind = KittiKind::tracking;
  options.skip_first_n = 2;
  options.only_first_n = 2;
  std::size_t stated = 0;
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options,
                                   [&stated](double, std::size_t scans) { stated = scans; });
  EXPECT_EQ(2U, result.scans);
  EXPECT_EQ(2U, stated);
  EXPECT_EQ(1U, trueBoxes(folder, 1).size());
  options.skip_first_n = 5;
  EXPECT_THROW(convertKitti(folder.file("in"), folder.file("x.rawlog"), options), UserError);
}

TEST(KittiTruth, TheTruthStatesItsSource)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 2);
  folder.write("in/calib.txt", tracking_calib);
  folder.write("in/oxts.txt", oxtsLine(0) + oxtsLine(1));
  const auto originWith = [&](const KittiConverterOptions& options)
  {
    (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
    return poseOrigin(folder.file("x.gt"));
  };
  KittiConverterOptions options;
  options.kind = KittiKind::tracking;
  EXPECT_EQ(PoseSource::gnss_ins, originWith(options).source);
  EXPECT_EQ("oxts.txt", originWith(options).name);
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(contains(result.notes.back(), "GNSS/INS (oxts.txt)")) << result.notes.back();
  EXPECT_TRUE(contains(result.notes.at(1), "--imu and --gnss convert them")) << result.notes.at(1);
  options.poses = folder.file("icp.txt");
  writeKittiPoses(options.poses, std::vector<Pose>{somePose(0), somePose(1)});
  EXPECT_EQ(PoseSource::given, originWith(options).source);
  EXPECT_EQ("icp.txt", originWith(options).name);
  options.pose_source = PoseSource::simulated;
  EXPECT_TRUE(originWith(options).isExact());
  options = {};
  options.kind = KittiKind::tracking;
  options.no_truth = true;
  EXPECT_EQ(PoseSource::unknown, originWith(options).source) << "of the conversion before";
}

TEST(KittiTruth, MissingCalibrationCostsTheTruthOnly)
{
  const TestFolder folder;
  const std::string drive = writeRawDrive(folder);
  KittiConverterOptions options;
  options.kind = KittiKind::raw;
  const auto convert = [&]
  { return convertKitti(folder.file(drive), folder.file("x.rawlog"), options); };
  const auto without = convert();
  EXPECT_EQ(2U, without.scans);
  EXPECT_EQ(0U, without.poses);
  ASSERT_EQ(1U, without.warnings.size());
  EXPECT_TRUE(contains(without.warnings[0], "calib_imu_to_velo.txt")) << without.warnings[0];
  EXPECT_TRUE(contains(without.warnings[0], "without true poses"));
  // GNSS needs no camera.
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  EXPECT_EQ(2U, convert().poses);
  std::filesystem::rename(folder.file("2011_09_26/calib_imu_to_velo.txt"),
                          folder.file("calib_imu_to_velo.txt"));
  EXPECT_EQ(0U, convert().poses);
  options.calib = folder.file("calib_imu_to_velo.txt");
  EXPECT_EQ(2U, convert().poses);
  options.no_truth = true;
  EXPECT_EQ(0U, convert().poses);
  EXPECT_TRUE(convert().warnings.empty());
  // What was asked for must be there.
  options = {};
  options.kind = KittiKind::raw;
  options.oxts = folder.file(drive + "oxts");
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)convert(); }), "--calib"));
}

TEST(KittiTruth, BoxesWithoutANumberGetOne)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 2);
  const auto box = [](const std::string& id)
  {
    return "{" + id +
           R"("obj_type": "Car", "psr": {"position": {"x": 1, "y": 2, "z": 0},)"
           R"("scale": {"x": 4, "y": 2, "z": 1.5}, "rotation": {"x": 0, "y": 0, "z": 0}}})";
  };
  folder.write("in/label_json/000000.json",
               "[" + box(R"("obj_id": "7",)") + "," + box(R"("obj_id": "",)") + "]");
  folder.write("in/label_json/000001.json", "[" + box(R"("obj_id": "7",)") + "," + box("") + "]");
  const auto result =
      convertKitti(folder.file("in"), folder.file("x.rawlog"), KittiConverterOptions{});
  EXPECT_EQ(4U, result.boxes);
  EXPECT_TRUE(contains(result.warnings.back(), "2 of 4 boxes")) << result.warnings.back();
  const auto boxes = readTracks(folder.file("x.gt/tracks.txt"));
  std::vector<int> ids;
  for (const auto& one : boxes)
  {
    ids.push_back(one.id);
  }
  EXPECT_EQ((std::vector<int>{7, 8, 7, 9}), ids);
}

/** A pose within 0.2 s before and after a scan is needed; poses of the camera are converted. */
TEST(KittiTruth, PosesWithTimes)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 3);
  KittiConverterOptions options;
  options.times = folder.write("t.txt", "10\n10.1\n11\n");
  options.poses =
      folder.write("poses.tum", "9.95 0 0 0 0 0 0 1\n10.15 2 0 0 0 0 0 1\n20 9 0 0 0 0 0 1\n");
  options.pose_frame = PoseFrame::lidar;
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(contains(result.warnings.at(0), "has no pose for 1 of 3")) << result.warnings[0];
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_TRUE(frames.at(1).T_world_vehicle_truth);
  EXPECT_NEAR(frames[1].T_world_vehicle_truth->translation().x(), 1.5, 1e-6);
  EXPECT_FALSE(frames.at(2).T_world_vehicle_truth);
  // Poses of the scans whose times have fewer decimals.
  options.times = folder.write("t.txt", "9.949999653\n10.000000347\n10.150000456\n");
  EXPECT_EQ(3U, convertKitti(folder.file("in"), folder.file("x.rawlog"), options).poses);
  options.times = folder.write("t.txt", "10\n10.1\n11\n");
  options.pose_frame = PoseFrame::camera;
  EXPECT_TRUE(
      contains(messageOfError<UserError>(
                   [&] { convertKitti(folder.file("in"), folder.file("x.rawlog"), options); }),
               "--calib"));
}

/** Poses with times could belong to any of the scans, if these have none. */
TEST(KittiTruth, PosesWithTimesForScansWithoutAny)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 3);
  KittiConverterOptions options;
  options.pose_frame = PoseFrame::lidar;
  const std::string row = " 0 0 0 0 0 1\n";
  options.poses = folder.write("poses.tum", "10 0" + row + "10 0" + row + "10.2 2" + row);
  EXPECT_TRUE(
      contains(messageOfError<UserError>(
                   [&] { convertKitti(folder.file("in"), folder.file("x.rawlog"), options); }),
               "poses.tum: has poses at 2 times, but there are 3 scans without times; give "
               "--times"));
  options.poses = folder.write("all.tum", "10 0" + row + "10.1 1" + row + "10.2 2" + row);
  convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_NEAR(readAll(folder.file("x.rawlog")).at(1).T_world_vehicle_truth->translation().x(), 1,
              1e-6);
  options.poses =
      folder.write("more.tum", "10 0" + row + "10.05 1" + row + "10.1 2" + row + "10.15 3" + row);
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(std::any_of(result.warnings.begin(), result.warnings.end(),
                          [](const std::string& line)
                          {
                            return contains(line,
                                            "has poses at 4 times, but there are 3 scans without "
                                            "times: each has the pose in the line of its number");
                          }));
}

/** A part of a drive, whose scans keep their numbers: a pose for each number or for each scan. */
TEST(KittiTruth, PosesOfScansThatAreNotNumberedFromZero)
{
  const TestFolder folder;
  writeBins(folder, "in/velodyne", 4);
  std::filesystem::remove(folder.file("in/velodyne/000000.bin"));
  std::filesystem::remove(folder.file("in/velodyne/000001.bin"));
  KittiConverterOptions options;
  options.pose_frame = PoseFrame::lidar;
  options.poses = folder.file("poses.txt");
  const auto writePoses = [&](int count)
  {
    std::string text;
    for (int i = 0; i < count; ++i)
    {
      text += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
    }
    folder.write("poses.txt", text);
  };
  const auto firstPose = [&]
  {
    (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
    return readAll(folder.file("x.rawlog")).at(0).T_world_vehicle_truth->translation().x();
  };
  writePoses(4);
  EXPECT_NEAR(2, firstPose(), 1e-6);
  writePoses(2);
  EXPECT_NEAR(0, firstPose(), 1e-6);
  for (const int count : {1, 3})
  {
    writePoses(count);
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)firstPose(); }),
                         "there are 2 scans, numbered from 2 to 3; a pose for each scan or for "
                         "each number is needed"))
        << count;
  }
}
}  // namespace dyslam
