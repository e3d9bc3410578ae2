// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/RawlogSource.h>

#include "ScanFolders.h"

namespace dyslam
{
namespace
{
/** A reading of oxts: at (0.1 k, 0.2 k, 0.3 k) rad/s and (k, 0, 9.81) m/s^2. */
std::string readingLine(std::size_t k)
{
  const auto n = static_cast<double>(k);
  const auto numbers = [](std::initializer_list<double> values)
  {
    std::string text;
    for (const double value : values)
    {
      text += " " + std::to_string(value);
    }
    return text;
  };
  return "49 8.4 110 0 0 0 0 0 10 1 2" + numbers({n, 0, 9.81, 0, 0, 0}) +
         numbers({0.1 * n, 0.2 * n, 0.3 * n}) + " 0 0 0 0.05 0 4 10 4 4 0\n";
}

const char* const calib_with_imu =
    "R_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\n"
    "Tr_imu_velo 0 -1 0 -0.8 1 0 0 0.3 0 0 1 -0.9\n";
const Pose T_velo_imu = poseFromYpr(-0.8, 0.3, -0.9, M_PI / 2, 0, 0);

/** `count` scans with a file of readings, without calibration. */
void writePlainFolder(const TestFolder& folder, std::size_t count)
{
  writeBins(folder, "in/velodyne", count);
  std::string times;
  std::string readings;
  for (std::size_t i = 0; i < count; ++i)
  {
    times += std::to_string(0.1 * static_cast<double>(i)) + "\n";
    readings += readingLine(i);
  }
  folder.write("in/times.txt", times);
  folder.write("in/oxts.txt", readings);
}
}  // namespace

TEST(KittiImu, ReadingsAtTheTimesOfTheScans)
{
  const TestFolder folder;
  writePlainFolder(folder, 4);
  folder.write("in/calib.txt", calib_with_imu);
  KittiConverterOptions options;
  options.kind = KittiKind::tracking;
  options.sensor_pose = "1 0 2 0 0 0";
  (void)convertKitti(folder.file("in"), folder.file("without.rawlog"), options);
  options.imu = true;
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_EQ("IMU: 4 samples of oxts", result.notes.back());
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(4U, frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    const auto n = static_cast<double>(i);
    ASSERT_EQ(1U, frames[i].imu.size());
    const ImuSample& sample = frames[i].imu[0];
    EXPECT_NEAR(frames[i].scan.stamp, sample.stamp, 1e-6);
    EXPECT_TRUE(sample.angular_velocity.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3) * n, 1e-6));
    ASSERT_TRUE(sample.acceleration);
    EXPECT_TRUE(sample.acceleration->isApprox(Eigen::Vector3d(n, 0, 9.81), 1e-6));
    EXPECT_TRUE(sample.T_vehicle_imu.isApprox(poseFromYpr(1, 0, 2, 0, 0, 0) * T_velo_imu, 1e-6));
    EXPECT_TRUE(frames[i].wheels.empty());  // the speed of the INS is aided by GNSS
  }
  for (const Frame& frame : readAll(folder.file("without.rawlog")))
  {
    EXPECT_TRUE(frame.imu.empty());
  }
}

TEST(KittiImu, PositionsAtTheTimesOfTheScans)
{
  const TestFolder folder;
  writePlainFolder(folder, 3);
  folder.write("in/calib.txt", calib_with_imu);
  KittiConverterOptions options;
  options.kind = KittiKind::tracking;
  options.gnss = true;
  const auto result = convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  EXPECT_EQ("satellite receiver: 3 positions of oxts", result.notes.back());
  for (const Frame& frame : readAll(folder.file("x.rawlog")))
  {
    EXPECT_TRUE(frame.imu.empty());
    ASSERT_EQ(1U, frame.gnss.size());
    EXPECT_EQ(49, frame.gnss[0].position.latitude);
    EXPECT_EQ(110, frame.gnss[0].position.height);
    EXPECT_TRUE(frame.gnss[0].antenna.isApprox(T_velo_imu.translation(), 1e-6));
    EXPECT_NEAR(0.05, frame.gnss[0].horizontal_sigma, 1e-6);
  }
}

TEST(KittiImu, LostScansAndPartsOfADrive)
{
  const TestFolder folder;
  writePlainFolder(folder, 6);
  folder.write("in/calib.txt", calib_with_imu);
  std::filesystem::remove(folder.file("in/velodyne/000002.bin"));
  KittiConverterOptions options;
  options.imu = true;
  options.no_truth = true;
  options.skip_first_n = 1;
  options.only_first_n = 3;
  (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options);
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(3U, frames.size());         // numbers 1, 3, 4
  ASSERT_EQ(2U, frames[0].imu.size());  // from 1 s before the first scan on
  EXPECT_NEAR(0.1, frames[0].imu[1].angular_velocity.x(), 1e-6);
  ASSERT_EQ(1U, frames[1].imu.size());
  EXPECT_NEAR(0.3, frames[1].imu[0].angular_velocity.x(), 1e-6);
  EXPECT_NEAR(0.3, frames[1].imu[0].stamp, 1e-6);
}

TEST(KittiImu, RawDrivesHaveTimesOfTheReadings)
{
  const TestFolder folder;
  const std::string drive = "2011_09_26/2011_09_26_drive_0001_sync/";
  writeBins(folder, drive + "velodyne_points/data", 2, 10);
  folder.write(drive + "velodyne_points/timestamps.txt",
               "2011-09-26 13:02:25.95\n2011-09-26 13:02:26.05\n");
  folder.write(drive + "oxts/data/0000000000.txt", readingLine(0));
  folder.write(drive + "oxts/data/0000000001.txt", readingLine(1));
  folder.write(drive + "oxts/timestamps.txt", "2011-09-26 13:02:25.94\n2011-09-26 13:02:26.04\n");
  folder.write("2011_09_26/calib_imu_to_velo.txt", "R: 0 -1 0 1 0 0 0 0 1\nT: -0.8 0.3 -0.9\n");
  KittiConverterOptions options;
  options.kind = KittiKind::raw;
  options.imu = true;
  const auto timeBeforeScan = [&](std::size_t number)
  {
    (void)convertKitti(folder.file(drive), folder.file("x.rawlog"), options);
    const Frame frame = readAll(folder.file("x.rawlog")).at(number);
    EXPECT_TRUE(frame.imu.at(0).T_vehicle_imu.isApprox(T_velo_imu, 1e-6));
    return frame.scan.stamp - frame.imu.at(0).stamp;
  };
  EXPECT_NEAR(0.01, timeBeforeScan(1), 1e-5);
  for (const char* named : {"oxts", "oxts/data", "oxts/data/"})
  {
    options.oxts = folder.file(drive + named);
    EXPECT_NEAR(0.01, timeBeforeScan(1), 1e-5) << named;
  }
  options.dt = 0.1;  // no longer the times of the drive
  EXPECT_NEAR(0, timeBeforeScan(1), 1e-6);
  options.dt = 0;
  folder.write(drive + "oxts/timestamps.txt", "2011-09-26 13:02:25.94\n");
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&] { (void)convertKitti(folder.file(drive), folder.file("x.rawlog"), options); }),
      "has 1 time, but there are 2 readings"));
}

TEST(KittiImu, Errors)
{
  const TestFolder folder;
  writePlainFolder(folder, 2);
  KittiConverterOptions options;
  options.imu = true;
  const auto message = [&]
  {
    return messageOfError<UserError>(
        [&] { (void)convertKitti(folder.file("in"), folder.file("x.rawlog"), options); });
  };
  EXPECT_TRUE(contains(message(), "needed for --imu; name it with --calib"));
  folder.write("in/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  EXPECT_TRUE(contains(message(), "has no IMU mounting (Tr_imu_velo)"));
  std::filesystem::remove(folder.file("in/oxts.txt"));
  EXPECT_TRUE(contains(message(), "has no oxts, which is needed for --imu; name it with --oxts"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog")));
}
}  // namespace dyslam
