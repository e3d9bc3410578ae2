// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/Converters.h>
#include <dyslam/io/RawlogSource.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>

#include "BagWriters.h"
#include "RosMessageWriters.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr double begin_of_drive = 1600000000;  //!< [s]
constexpr double scan_period = 0.125;          //!< [s]
constexpr double sample_period = 0.03125;      //!< of IMU and odometry [s]
constexpr std::size_t drive_scans = 5;
constexpr std::size_t drive_samples = 100;  //!< from 2 s before the first scan

double scanStamp(std::size_t number)
{
  return begin_of_drive + scan_period * static_cast<double>(number);
}

double sampleStamp(std::size_t number)
{
  return begin_of_drive - 2 + sample_period * static_cast<double>(number);
}

using MessageOf = std::function<std::string(bool cdr, std::size_t number, double stamp)>;

/** A message with a scan of 40 points, with times and rings. */
std::string scanMessage(bool cdr, std::size_t number, const std::string& frame = "lidar")
{
  Scan scan = someScan(number, 40);
  for (std::size_t k = 0; k < scan.size(); ++k)
  {
    scan.time.push_back(1e-3F * static_cast<float>(k));
    scan.ring.push_back(static_cast<std::uint16_t>(k % 16));
  }
  return test::pointCloud2(cdr, scanStamp(number), test::velodyneFields(scan), 1, frame);
}

/** Scans that are received 0.1 s after their stamp, and samples of a topic that are at once. */
void writeDrive(const std::string& path,
                const std::string& topic,
                const std::string& type,
                const MessageOf& messageOf,
                const std::vector<std::pair<std::string, Pose>>& tf_static = {},
                std::size_t samples = drive_samples,
                const std::string& scan_frame = "lidar")
{
  const bool cdr = test::holdsCdr(path);
  std::vector<test::TestMessage> messages;
  if (!tf_static.empty())
  {
    const double stamp = sampleStamp(0);
    messages.push_back(
        {"/tf_static", "tf2_msgs/TFMessage", stamp, test::transforms(cdr, stamp, tf_static)});
  }
  for (std::size_t i = 0; i < drive_scans; ++i)
  {
    messages.push_back({"/points", "sensor_msgs/PointCloud2", scanStamp(i) + 0.1,
                        scanMessage(cdr, i, scan_frame)});
  }
  for (std::size_t i = 0; i < samples; ++i)
  {
    const double stamp = sampleStamp(i);
    messages.push_back({topic, type, stamp, messageOf(cdr, i, stamp)});
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  test::writeBag(path, messages);
}

std::string imuMessage(bool cdr, std::size_t number, double stamp)
{
  test::ImuValues values;
  values.angular_velocity.z() = static_cast<double>(number);
  values.acceleration = {0, 0, 9.81};
  return test::imu(cdr, stamp, values);
}

void writeImuDrive(const std::string& path,
                   const std::vector<std::pair<std::string, Pose>>& tf_static = {})
{
  writeDrive(path, "/imu/data", "sensor_msgs/Imu", imuMessage, tf_static);
}

/** The samples between the scans, each at or before the stamp of its scan; those of the first one
 * from 1 s before. */
template <typename Sample>
void expectInOrder(const std::vector<Frame>& frames, std::vector<Sample> Frame::*samples)
{
  double last = begin_of_drive - 1 - sample_period;
  for (const Frame& frame : frames)
  {
    for (const Sample& sample : frame.*samples)
    {
      EXPECT_NEAR(last + sample_period, sample.stamp, 1e-6);
      last = sample.stamp;
    }
    EXPECT_NEAR(frame.scan.stamp, last, 1e-6);
  }
}
}  // namespace

TEST(BagMotion, ImuBetweenTheScans)
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
TEST(BagMotion, VehicleOfTheBag)
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

/** Drivers of ROS 1 put a slash before the names of frames, which the transforms do not have. */
TEST(BagMotion, SlashesBeforeFramesAreIgnored)
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
TEST(BagMotion, SamplesThatAreReceivedLateStandBeforeTheirScan)
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
TEST(BagMotion, SamplesThatAreOlderThanEveryScanAreReported)
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
TEST(BagMotion, ScansBeforeDamagedDataAreKept)
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

/** The velocities of wheels come later than those of the IMU. */
TEST(BagMotion, ScansWaitForBothSensors)
{
  const TestFolder folder;
  std::vector<test::TestMessage> messages;
  for (int i = -20; i < 60; ++i)
  {
    const double stamp = begin_of_drive + sample_period * i;
    messages.push_back({"/imu", "sensor_msgs/Imu", stamp, test::imu(false, stamp, {})});
    messages.push_back({"/speed", "geometry_msgs/TwistStamped", stamp + 0.5,
                        test::twistStamped(false, stamp, {2, 0, 0}, {0, 0, 0})});
  }
  messages.push_back({"/points", "sensor_msgs/PointCloud2", scanStamp(0), scanMessage(false, 0)});
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  test::writeBag(folder.file("x.bag"), messages);
  ScanConverterOptions options;
  options.imu_topic = "/imu";
  options.odometry_topic = "/speed";
  (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(1U, frames.size());
  EXPECT_EQ(21U, frames[0].imu.size());
  EXPECT_EQ(21U, frames[0].wheels.size());
}

TEST(BagMotion, WithoutTheOptionOnlyANoteNamesTheTopic)
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

TEST(BagMotion, TheImuIsMountedByTransformsOrByTheOption)
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

TEST(BagMotion, SamplesOfTheConvertedPartOnly)
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

TEST(BagMotion, SamplesWithoutAnAngularVelocityAreCounted)
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
TEST(BagMotion, SamplesOfAnotherClockAreReported)
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

TEST(BagMotion, SpeedsOfEveryType)
{
  const TestFolder folder;
  const Eigen::Vector3d linear(8, 0.5, 0);
  const Eigen::Vector3d angular(0, 0, 0.25);
  struct Case
  {
    std::string type;
    MessageOf message;
  };
  const std::vector<Case> cases{
      {"nav_msgs/Odometry", [&](bool cdr, std::size_t, double stamp)
       { return test::odometry(cdr, stamp, Pose::Identity(), linear, angular); }},
      {"geometry_msgs/TwistStamped", [&](bool cdr, std::size_t, double stamp)
       { return test::twistStamped(cdr, stamp, linear, angular); }},
      {"geometry_msgs/TwistWithCovarianceStamped", [&](bool cdr, std::size_t, double stamp)
       { return test::twistStamped(cdr, stamp, linear, angular, true); }}};
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  for (const Case& one : cases)
  {
    for (const std::string ending : {".bag", ".mcap"})
    {
      writeDrive(folder.file("x" + ending), "/odom", one.type, one.message);
      const auto result = convertScans(folder.file("x" + ending), folder.file("x.rawlog"), options);
      EXPECT_TRUE(hasLine(result.notes, "wheel odometry: /odom, 49 samples")) << one.type;
      const auto frames = readAll(folder.file("x.rawlog"));
      expectInOrder(frames, &Frame::wheels);
      EXPECT_NEAR(8, frames.at(2).wheels.at(0).forward_speed, 1e-9);
      EXPECT_NEAR(0.25, frames[2].wheels[0].yaw_rate, 1e-9);
    }
  }
}

/** The vehicle is the lidar, which looks backwards 2 m before and 1 m to the left of base_link. */
TEST(BagMotion, SpeedsAreThoseOfTheVehiclesOrigin)
{
  const TestFolder folder;
  const auto message = [](bool cdr, std::size_t, double stamp) {
    return test::twistStamped(cdr, stamp, {8, 0, 0}, {0, 0, 0.5});
  };
  writeDrive(folder.file("x.bag"), "/odom", "geometry_msgs/TwistStamped", message,
             {{"base_link", Pose::Identity()}, {"lidar", poseFromYpr(2, 1, 0, M_PI, 0, 0)}});
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  const auto sample = [&]
  {
    (void)convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
    return readAll(folder.file("x.rawlog")).at(1).wheels.at(0);
  };
  EXPECT_NEAR(-7.5, sample().forward_speed, 1e-9);
  EXPECT_NEAR(0.5, sample().yaw_rate, 1e-9);
  options.sensor_pose = "2 1 0 180 0 0";  // the vehicle is base_link
  EXPECT_NEAR(8, sample().forward_speed, 1e-9);
}

/** Drivers that fill in the pose alone. */
TEST(BagMotion, PosesReplaceVelocitiesThatAreAllZero)
{
  const TestFolder folder;
  const double speed = 4;
  const double yaw_rate = 0.5;
  const auto message = [&](bool cdr, std::size_t, double stamp)
  {
    const double time = stamp - sampleStamp(0);
    Vector6 motion = Vector6::Zero();
    motion[0] = speed * time;
    motion[5] = yaw_rate * time;
    return test::odometry(cdr, stamp, expSE3(motion));
  };
  writeDrive(folder.file("x.bag"), "/odom", "nav_msgs/Odometry", message);
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_TRUE(hasLine(result.notes, "velocities of /odom are all zero"));
  const auto frames = readAll(folder.file("x.rawlog"));
  ASSERT_EQ(drive_scans, frames.size());
  for (std::size_t i = 1; i < frames.size(); ++i)
  {
    ASSERT_EQ(4U, frames[i].wheels.size());
    EXPECT_NEAR(scanStamp(i) - 0.5 * sample_period, frames[i].wheels[3].stamp, 1e-6);
    EXPECT_NEAR(speed, frames[i].wheels[3].forward_speed, 1e-6);
    EXPECT_NEAR(yaw_rate, frames[i].wheels[3].yaw_rate, 1e-6);
  }
}

TEST(BagMotion, AVehicleThatStandsHasSpeedsOfZero)
{
  const TestFolder folder;
  const auto message = [](bool cdr, std::size_t, double stamp)
  { return test::odometry(cdr, stamp, poseFromYpr(1, 2, 0, 0.5, 0, 0)); };
  writeDrive(folder.file("x.bag"), "/odom", "nav_msgs/Odometry", message);
  ScanConverterOptions options;
  options.odometry_topic = "/odom";
  const auto result = convertScans(folder.file("x.bag"), folder.file("x.rawlog"), options);
  EXPECT_FALSE(hasLine(result.notes, "all zero"));
  EXPECT_NEAR(0, readAll(folder.file("x.rawlog")).at(1).wheels.at(0).forward_speed, 1e-9);
}

TEST(BagMotion, PositionsOfASatelliteReceiver)
{
  const TestFolder folder;
  const std::string rawlog = folder.file("x.rawlog");
  const Pose T_map_lidar = poseFromYpr(0, 0, 1, 0, 0, 0);
  const Pose T_map_gps = poseFromYpr(0.5, -0.25, 1.5, 0, 0, 0);
  const auto fixMessage = [](bool cdr, std::size_t number, double stamp)
  {
    test::FixValues values;
    values.latitude += 1e-5 * static_cast<double>(number);
    values.status = number % 10 == 9 ? -1 : 0;
    values.variance = number % 2 == 0 ? 2.25 : 0;
    return test::navSatFix(cdr, stamp, values);
  };
  for (const std::string ending : {".bag", ".db3", ".mcap"})
  {
    writeDrive(folder.file("x" + ending), "/fix", "sensor_msgs/NavSatFix", fixMessage,
               {{"lidar", T_map_lidar}, {"gps", T_map_gps}});
    ScanConverterOptions options;
    EXPECT_TRUE(hasLine(convertScans(folder.file("x" + ending), rawlog, options).notes,
                        "--gnss-topic adds the positions of a satellite receiver: /fix"));
    options.gnss_topic = "/fix";
    options.base_frame = "map";
    const auto result = convertScans(folder.file("x" + ending), rawlog, options);
    EXPECT_TRUE(
        hasLine(result.notes, "satellite receiver: /fix, 44 samples; antenna at the frame"));
    EXPECT_TRUE(hasLine(result.warnings, "10 messages without a fix left out"));
    std::size_t fixes = 0;
    for (const Frame& frame : readAll(rawlog))
    {
      for (const GnssFix& fix : frame.gnss)
      {
        ++fixes;
        const auto number = std::lround((fix.stamp - sampleStamp(0)) / sample_period);
        EXPECT_NE(9, number % 10);
        EXPECT_NEAR(49 + 1e-5 * static_cast<double>(number), fix.position.latitude, 1e-12);
        EXPECT_NEAR(8.4, fix.position.longitude, 1e-12);
        EXPECT_NEAR(115, fix.position.height, 1e-9);
        EXPECT_NEAR(number % 2 == 0 ? 1.5 : 0, fix.horizontal_sigma, 1e-6);
        EXPECT_NEAR(number % 2 == 0 ? 3 : 0, fix.vertical_sigma, 1e-6);
        EXPECT_TRUE(fix.antenna.isApprox(T_map_gps.translation(), 1e-6));
      }
    }
    EXPECT_EQ(44U, fixes);
  }
}

TEST(BagMotion, Errors)
{
  const TestFolder folder;
  writeImuDrive(folder.file("x.bag"));
  ScanConverterOptions options;
  const auto message = [&](const std::string& name)
  {
    return messageOfError<UserError>(
        [&] { (void)convertScans(folder.file(name), folder.file("x.rawlog"), options); });
  };
  options.imu_topic = "/imu";
  EXPECT_TRUE(contains(message("x.bag"), "--imu-topic /imu is not in it; use /imu/data"));
  options.imu_topic = "/points";
  EXPECT_TRUE(contains(message("x.bag"), "sensor_msgs/PointCloud2 is not read; use /imu/data"));
  options.imu_topic = "";
  options.odometry_topic = "/imu/data";
  EXPECT_TRUE(contains(message("x.bag"),
                       "--odometry-topic /imu/data: sensor_msgs/Imu is not read; --list shows"));
  options = {};
  options.imu_pose = "0 0 0 0 0 0";
  EXPECT_TRUE(contains(message("x.bag"), "--imu-topic is mounted; give that, too"));
  options.imu_topic = "/imu/data";
  options.imu_pose = "1 2";
  EXPECT_TRUE(contains(message("x.bag"), "--imu-pose '1 2': six numbers"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.rawlog")));
  options = {};
  options.imu_topic = "/imu";
  folder.write("scans/000000.bin", "");
  EXPECT_TRUE(contains(message("scans"), "--imu-topic works with a bag only"));
}
}  // namespace dyslam
