// SPDX-License-Identifier: BSD-3-Clause
// The IMU of a bag beside the scans.
#include <dyslam/base/Error.h>
#include <dyslam/io/ScanConverter.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>

#include "MotionBags.h"
#include "TestFolder.h"

namespace dyslam
{
TEST(BagImu, ImuBetweenTheScans)
{
  const TestFolder folder;
  const std::string rawlog = folder.file("x.rawlog");
  std::string bytes;
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    writeImuDrive(folder.file("x" + ending));
    ScanConverterOptions options;
    options.imu_topic = "/imu/data";
    const auto result = convertScans(folder.file("x" + ending), rawlog, options);
    EXPECT_EQ(drive_scans, result.scans);
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_TRUE(hasLine(result.notes, "IMU: /imu/data, 49 samples; its axes are assumed"));
    const auto frames = readAll(rawlog);
    ASSERT_EQ(drive_scans, frames.size());
    expectInOrder(frames, &Frame::imu);
    for (const Frame& frame : frames)
    {
      const ImuSample& sample = frame.imu.at(0);
      EXPECT_NEAR((sample.stamp - sampleStamp(0)) / sample_period, sample.angular_velocity.z(),
                  1e-4);
      ASSERT_TRUE(sample.acceleration);
      EXPECT_NEAR(9.81, sample.acceleration->z(), 1e-9);
      EXPECT_TRUE(sample.T_vehicle_imu.isApprox(Pose::Identity(), 1e-12));
      EXPECT_TRUE(frame.wheels.empty());
    }
    EXPECT_TRUE(bytes.empty() || bytes == folder.read("x.rawlog")) << ending;
    bytes = folder.read("x.rawlog");
  }
}

/** The lidar's pose on the vehicle, and with it those of the other sensors, by /tf_static. */
TEST(BagImu, VehicleOfTheBag)
{
  const TestFolder folder;
  const std::string input = folder.file("x.mcap");
  const std::string rawlog = folder.file("x.rawlog");
  const Pose T_base_lidar = poseFromYpr(0.5, 0, 1.2, M_PI, 0.2, 0);
  const Pose T_base_imu = poseFromYpr(0, 0.1, 0.3, 0, 0, M_PI / 2);
  writeImuDrive(input, {{"lidar", T_base_lidar}, {"imu_link", T_base_imu}});
  ScanConverterOptions options;
  options.imu_topic = "/imu/data";
  EXPECT_TRUE(hasLine(convertScans(input, rawlog, options).notes,
                      "--base-frame map takes the pose of the lidar"));
  options.base_frame = "map";  // as the transforms of writeDrive() have it
  const auto result = convertScans(input, rawlog, options);
  EXPECT_TRUE(hasLine(result.notes, "the vehicle is map"));
  for (const Frame& frame : readAll(rawlog))
  {
    EXPECT_TRUE(frame.scan.T_vehicle_lidar.isApprox(T_base_lidar, 1e-6));
    EXPECT_TRUE(frame.imu.at(0).T_vehicle_imu.isApprox(T_base_imu, 1e-6));
  }
  const auto error = [&]
  { return messageOfError<UserError>([&] { (void)convertScans(input, rawlog, options); }); };
  options.base_frame = "base";
  EXPECT_TRUE(contains(error(), "--base-frame base: /tf_static does not connect it to 'lidar'"));
  EXPECT_TRUE(contains(error(), "it has the frames imu_link, lidar, map;"));
  options.sensor_pose = "0 0 1 0 0 0";
  EXPECT_TRUE(contains(error(), "give one of them"));
}

TEST(BagImu, AFrameWithTwoParentsIsReported)
{
  const TestFolder folder;
  const std::string input = folder.file("x.mcap");
  const Pose T_base_lidar = poseFromYpr(0.5, 0, 1.2, 0, 0, 0);
  std::string second_parent;
  const auto message = [&](bool cdr, std::size_t number, double stamp)
  {
    return test::transforms(cdr, stamp, {{"lidar", T_base_lidar}},
                            number == 0 ? "base_link" : second_parent);
  };
  ScanConverterOptions options;
  options.base_frame = "base_link";
  const auto write = [&](const std::string& parent)
  {
    second_parent = parent;
    writeDrive(input, "/tf_static", "tf2_msgs/TFMessage", message);
  };
  const std::string conflict =
      "/tf_static states two parents of 'lidar', 'base_link' and 'mast'; the last one counts";
  write("mast");
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] { (void)convertScans(input, folder.file("x.rawlog"), options); }),
                       "does not connect it to 'lidar'"));
  EXPECT_TRUE(contains(messageOfError<UserError>(
                           [&] { (void)convertScans(input, folder.file("x.rawlog"), options); }),
                       conflict));
  options.base_frame = "mast";
  EXPECT_TRUE(hasLine(convertScans(input, folder.file("x.rawlog"), options).warnings, conflict));

  write("base_link");  // the same transform, again and again
  options.base_frame = "base_link";
  EXPECT_FALSE(hasLine(convertScans(input, folder.file("x.rawlog"), options).warnings,
                       "/tf_static states two"));
}

/** ROS 1's static_transform_publisher repeats its transforms in /tf. */
TEST(BagImu, TheErrorOfTheBaseFrameNamesThePoseByTf)
{
  const TestFolder folder;
  const Pose T_base_lidar = poseFromYpr(1, 0, 1.7, M_PI, 0, 0);
  const auto message = [&](bool cdr, std::size_t, double stamp) {
    return test::transforms(cdr, stamp, {{"lidar", T_base_lidar}}, "base_link");
  };
  writeDrive(folder.file("x.bag"), "/tf", "tf2_msgs/TFMessage", message);
  ScanConverterOptions options;
  const auto error = [&]
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options); });
  };
  options.base_frame = "base_link";
  EXPECT_TRUE(contains(error(), "give --sensor-pose instead: '1 0 1.7 180 0 0' by /tf"));
  options.base_frame = "base";
  EXPECT_FALSE(contains(error(), "by /tf,"));
}

/** Drivers of ROS 1 put a slash before the names of frames, which the transforms do not have. */
TEST(BagImu, SlashesBeforeFramesAreIgnored)
{
  const TestFolder folder;
  const Pose T_base_lidar = poseFromYpr(0.5, 0, 1.2, M_PI, 0.2, 0);
  const Pose T_base_imu = poseFromYpr(0, 0.1, 0.3, 0, 0, M_PI / 2);
  const auto message = [](bool cdr, std::size_t, double stamp)
  {
    test::ImuValues values;
    values.frame = "/imu_link";
    return test::imu(cdr, stamp, values);
  };
  writeDrive(folder.file("x.bag"), "/imu", "sensor_msgs/Imu", message,
             {{"lidar", T_base_lidar}, {"/imu_link", T_base_imu}}, drive_samples, "/lidar");
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  options.base_frame = "/map";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.notes, "the vehicle is map, in which /tf_static places the lidar"));
  for (const Frame& frame : readAll(folder.file("x.rawlog")))
  {
    EXPECT_TRUE(frame.scan.T_vehicle_lidar.isApprox(T_base_lidar, 1e-6));
    EXPECT_TRUE(frame.imu.at(0).T_vehicle_imu.isApprox(T_base_imu, 1e-6));
  }
}

/** A sensor with a latency above that of the scans: the scans wait for its samples. */
TEST(BagImu, SamplesThatAreReceivedLateStandBeforeTheirScan)
{
  const TestFolder folder;
  constexpr double latency = 0.4375;  // [s]
  const auto message = [](bool cdr, std::size_t, double received)
  { return test::imu(cdr, received - latency, {}); };
  for (const std::string ending : {".bag", ".mcap"})
  {
    writeDrive(folder.file("x" + ending), "/imu", "sensor_msgs/Imu", message);
    ScanConverterOptions options;
    options.imu_topic = "/imu";
    const auto result = convertScans(folder.file("x" + ending), folder.file("x.rawlog"), options);
    EXPECT_TRUE(result.warnings.empty());
    const auto frames = readAll(folder.file("x.rawlog"));
    ASSERT_EQ(drive_scans, frames.size());
    expectInOrder(frames, &Frame::imu);
    options.only_first_n = 2;
    EXPECT_EQ(2U, convertScans(folder.file("x" + ending), folder.file("x.rawlog"), options).scans);
  }
}

/** A clock that is 1.5 s behind: a scan waits for 1 s, and all samples are kept. */
TEST(BagImu, SamplesThatAreOlderThanEveryScanAreReported)
{
  const TestFolder folder;
  constexpr double latency = 1.5;  // [s]
  const auto message = [](bool cdr, std::size_t, double received)
  { return test::imu(cdr, received - latency, {}); };
  writeDrive(folder.file("x.bag"), "/imu", "sensor_msgs/Imu", message, {}, 160);
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.warnings,
                      "/imu: has no sample at the times of the scans, all are "
                      "more than 0.25 s older"));
  std::optional<double> last;
  for (const Frame& frame : readAll(folder.file("x.rawlog")))
  {
    ASSERT_FALSE(frame.imu.empty());
    for (const ImuSample& sample : frame.imu)
    {
      EXPECT_NEAR(last.value_or(begin_of_drive - 1 - sample_period) + sample_period, sample.stamp,
                  1e-6);
      last = sample.stamp;
    }
    // The scan is received 0.1 s behind its stamp.
    EXPECT_NEAR(frame.scan.stamp + 1.1 - latency, *last, sample_period);
  }
}

/** Damaged data while scans wait for samples. */
TEST(BagImu, ScansBeforeDamagedDataAreKept)
{
  const TestFolder folder;
  constexpr double latency = 0.4375;  // [s]
  const auto message = [](bool cdr, std::size_t, double received)
  { return received > begin_of_drive + 0.7 ? "x" : test::imu(cdr, received - latency, {}); };
  writeDrive(folder.file("x.bag"), "/imu", "sensor_msgs/Imu", message);
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  EXPECT_THROW((void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options),
               UserError);
  EXPECT_EQ(drive_scans, readAll(folder.file("x.rawlog")).size());
}

TEST(BagImu, WithoutTheOptionOnlyANoteNamesTheTopic)
{
  const TestFolder folder;
  writeImuDrive(folder.file("x.bag"));
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), {});
  EXPECT_TRUE(hasLine(result.notes, "--imu-topic /imu/data adds the gyroscope"));
  for (const Frame& frame : readAll(folder.file("x.rawlog")))
  {
    EXPECT_TRUE(frame.imu.empty());
  }
}

TEST(BagImu, TheImuIsMountedByTransformsOrByTheOption)
{
  const TestFolder folder;
  const Pose T_map_lidar = poseFromYpr(0.5, 0, 1, M_PI, 0, 0);
  const Pose T_map_imu = poseFromYpr(0.1, 0, 0.2, 0, 0, M_PI / 2);
  writeImuDrive(folder.file("x.bag"), {{"lidar", T_map_lidar}, {"imu_link", T_map_imu}});
  ScanConverterOptions options;
  options.imu_topic = "/imu/data";
  const auto mounting = [&]
  {
    (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
    return readAll(folder.file("x.rawlog")).at(1).imu.at(0).T_vehicle_imu;
  };
  const Pose T_lidar_imu = T_map_lidar.inverse() * T_map_imu;
  EXPECT_TRUE(mounting().isApprox(T_lidar_imu, 1e-6));
  options.sensor_pose = "1 0 2 90 0 0";
  const Pose T_vehicle_lidar = poseFromYpr(1, 0, 2, M_PI / 2, 0, 0);
  EXPECT_TRUE(mounting().isApprox(T_vehicle_lidar * T_lidar_imu, 1e-6));
  options.imu_pose = "0 0 1 0 0 180";
  EXPECT_TRUE(mounting().isApprox(poseFromYpr(0, 0, 1, 0, 0, M_PI), 1e-6));
}

TEST(BagImu, SamplesOfTheConvertedPartOnly)
{
  const TestFolder folder;
  writeImuDrive(folder.file("x.bag"));
  ScanConverterOptions options;
  options.imu_topic = "/imu/data";
  options.start = 0.2;
  options.end = 0.45;
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_EQ(2U, result.scans);
  const auto frames = readAll(folder.file("x.rawlog"));
  EXPECT_NEAR(scanStamp(2) - 1, frames.at(0).imu.front().stamp, 1e-6);
  EXPECT_NEAR(scanStamp(2), frames[0].imu.back().stamp, 1e-6);
  EXPECT_EQ(4U, frames.at(1).imu.size());
  EXPECT_NEAR(scanStamp(3), frames[1].imu.back().stamp, 1e-6);
  EXPECT_TRUE(hasLine(result.notes, "37 samples"));
}

TEST(BagImu, SamplesWithoutAnAngularVelocityAreCounted)
{
  const TestFolder folder;
  const auto message = [](bool cdr, std::size_t number, double stamp)
  {
    test::ImuValues values;
    values.angular_velocity.x() = number % 4 == 0 ? std::numeric_limits<double>::quiet_NaN() : 1;
    return test::imu(cdr, stamp, values);
  };
  writeDrive(folder.file("x.mcap"), "/imu", "sensor_msgs/Imu", message);
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  const auto result = convertScans(folder.file("x.mcap"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.warnings, "/imu: 25 messages without an angular velocity left out"));
  EXPECT_EQ(3U, readAll(folder.file("x.rawlog")).at(1).imu.size());
}

/** The clock of an IMU that counts from its start. */
TEST(BagImu, SamplesOfAnotherClockAreReported)
{
  const TestFolder folder;
  const auto message = [](bool cdr, std::size_t number, double)
  { return test::imu(cdr, 5 + sample_period * static_cast<double>(number), {}); };
  writeDrive(folder.file("x.bag"), "/imu", "sensor_msgs/Imu", message);
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.warnings, "/imu: has no sample at the times of the scans"));
  for (const Frame& frame : readAll(folder.file("x.rawlog")))
  {
    EXPECT_TRUE(frame.imu.empty());
  }
}
}  // namespace dyslam
