// SPDX-License-Identifier: BSD-3-Clause
// Samples of IMUs and wheel odometry in rawlogs, and the frames that they come with.
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <limits>

#include "MotionBytes.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using mrpt::obs::CObservationIMU;
using mrpt::obs::CObservationOdometry;
using test::bytesOf;
using test::imuAt;
using test::odometryAt;
using test::scanBytes;

constexpr double stamp_error = 2e-7;  //!< MRPT's ticks [s]

/** `count` scans every 0.1 s from 100 s on, an IMU's sample every 0.02 s and one of the wheels
 * every 0.05 s up to each; the clock is set back by `step` behind `before_step` scans. */
void writeSensedDrive(const std::string& path,
                      std::size_t count,
                      double step = 0,
                      std::size_t before_step = 0)
{
  RawlogWriter writer(path);
  for (std::size_t i = 0; i < count; ++i)
  {
    Scan scan = someScan(i, 5);
    scan.stamp -= step != 0 && i >= before_step ? step : 0;
    for (int k = 4; k >= 0; --k)
    {
      writer.write(test::imuSample(scan.stamp - 0.02 * k));
    }
    writer.write(WheelSample{scan.stamp - 0.05, 3, 0.1});
    writer.write(WheelSample{scan.stamp, 4, -0.1});
    writer.write(scan, somePose(i));
  }
  writer.close();
}

std::vector<Frame> framesOf(const std::string& path, const RawlogSourceOptions& options = {})
{
  RawlogSource source(path, options);
  std::vector<Frame> frames;
  while (auto frame = source.next())
  {
    frames.push_back(std::move(*frame));
  }
  return frames;
}

std::string linesOf(const std::string& path, const RawlogSourceOptions& options = {})
{
  RawlogSource source(path, options);
  while (source.next())
  {
  }
  std::string lines;
  for (const std::string& line : source.warnings())
  {
    lines += line + '\n';
  }
  return lines;
}
}  // namespace

TEST(MotionSampleReader, SamplesComeWithTheNextScan)
{
  const TestFolder folder;
  writeSensedDrive(folder.file("a.rawlog"), 6);
  const auto frames = framesOf(folder.file("a.rawlog"));
  ASSERT_EQ(6U, frames.size());
  for (const Frame& frame : frames)
  {
    ASSERT_EQ(5U, frame.imu.size());
    ASSERT_EQ(2U, frame.wheels.size());
    for (std::size_t k = 0; k < 5; ++k)
    {
      const double stamp = frame.scan.stamp - 0.02 * static_cast<double>(4 - k);
      EXPECT_NEAR(stamp, frame.imu[k].stamp, stamp_error);
      EXPECT_NEAR(std::sin(stamp), frame.imu[k].angular_velocity.z(), 1e-6);
      EXPECT_EQ(-0.2, frame.imu[k].angular_velocity.y());
      EXPECT_EQ(0.1, frame.imu[k].angular_velocity.x());
      EXPECT_FALSE(frame.imu[k].acceleration);
      EXPECT_TRUE(frame.imu[k].T_vehicle_imu.isApprox(test::imuSample(0).T_vehicle_imu, 1e-12));
    }
    EXPECT_NEAR(frame.scan.stamp - 0.05, frame.wheels[0].stamp, stamp_error);
    EXPECT_EQ(frame.scan.stamp, frame.wheels[1].stamp);
    EXPECT_EQ(3, frame.wheels[0].forward_speed);
    EXPECT_EQ(-0.1, frame.wheels[1].yaw_rate);
  }
  EXPECT_EQ("", linesOf(folder.file("a.rawlog")));
}

TEST(MotionSampleReader, ScansAreTheSameWithoutSensors)
{
  const TestFolder folder;
  writeSensedDrive(folder.file("with.rawlog"), 4);
  {
    RawlogWriter writer(folder.file("without.rawlog"));
    for (std::size_t i = 0; i < 4; ++i)
    {
      writer.write(someScan(i, 5), somePose(i));
    }
    writer.close();
  }
  const auto with = framesOf(folder.file("with.rawlog"));
  const auto without = framesOf(folder.file("without.rawlog"));
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i)
  {
    EXPECT_TRUE(without[i].imu.empty());
    EXPECT_TRUE(without[i].wheels.empty());
    EXPECT_EQ(with[i].index, without[i].index);
    EXPECT_EQ(with[i].scan.stamp, without[i].scan.stamp);
    EXPECT_TRUE(samePoints(with[i].scan, without[i].scan));
    EXPECT_EQ(with[i].T_world_vehicle_truth->matrix(), without[i].T_world_vehicle_truth->matrix());
  }
}

TEST(MotionSampleReader, AGyroscopeOfAnMrptFileIsRead)
{
  const TestFolder folder;
  {
    mrpt::io::CFileGZOutputStream file(folder.file("a.rawlog"));
    auto archive = mrpt::serialization::archiveFrom(file);
    CObservationIMU imu = imuAt(99.98);
    imu.sensorPose = mrpt::poses::CPose3D(1, 2, 3, 0.5, 0, 0);
    imu.set(mrpt::obs::IMU_X_ACC, 0.5);
    imu.set(mrpt::obs::IMU_Y_ACC, 0.25);
    imu.set(mrpt::obs::IMU_Z_ACC, 9.75);
    imu.set(mrpt::obs::IMU_YAW, 2);
    archive << imu << imuAt(99.99);
    const std::string scan = scanBytes(100);
    archive.WriteBuffer(scan.data(), scan.size());
  }
  const auto frames = framesOf(folder.file("a.rawlog"));
  ASSERT_EQ(1U, frames.size());
  ASSERT_EQ(2U, frames[0].imu.size());
  const ImuSample& sample = frames[0].imu[0];
  EXPECT_NEAR(99.98, sample.stamp, stamp_error);
  EXPECT_EQ(Eigen::Vector3d(0.1, 0.2, 0.3), sample.angular_velocity);
  EXPECT_EQ(Eigen::Vector3d(0.5, 0.25, 9.75), sample.acceleration.value());
  EXPECT_TRUE(sample.T_vehicle_imu.isApprox(poseFromYpr(1, 2, 3, 0.5, 0, 0), 1e-12));
  EXPECT_FALSE(frames[0].imu[1].acceleration);
}

TEST(MotionSampleReader, OnlyWholeAngularVelocitiesAreUsed)
{
  const TestFolder folder;
  CObservationIMU without = imuAt(99.91);
  without.dataIsPresent[mrpt::obs::IMU_WY] = false;
  without.sensorLabel = "compass";
  CObservationIMU not_finite = imuAt(99.92);
  not_finite.set(mrpt::obs::IMU_WX, std::numeric_limits<double>::quiet_NaN());
  CObservationIMU timeless = imuAt(99.93);
  timeless.timestamp = INVALID_TIMESTAMP;
  CObservationIMU half = imuAt(99.94);  // of an acceleration
  half.set(mrpt::obs::IMU_X_ACC, 1);
  half.set(mrpt::obs::IMU_Y_ACC, std::numeric_limits<double>::infinity());
  half.set(mrpt::obs::IMU_Z_ACC, 1);
  const std::string path = folder.write(
      "a.rawlog", bytesOf(without) + bytesOf(not_finite) + bytesOf(timeless) + bytesOf(half) +
                      bytesOf(imuAt(99.93)) + bytesOf(imuAt(99.94)) + scanBytes(100));
  const auto frames = framesOf(path);
  ASSERT_EQ(1U, frames.size());
  ASSERT_EQ(1U, frames[0].imu.size());
  EXPECT_NEAR(99.94, frames[0].imu[0].stamp, stamp_error);
  EXPECT_FALSE(frames[0].imu[0].acceleration);
  EXPECT_EQ("", linesOf(path));
}

TEST(MotionSampleReader, SpeedsOfWheelsAreVelocitiesOrDisplacements)
{
  const TestFolder folder;
  // On a circle of 20 m at 5 m/s.
  const auto onCircle = [](double stamp)
  {
    const double angle = 0.25 * stamp;
    return bytesOf(odometryAt(stamp, {20 * std::sin(angle), -20 * std::cos(angle), angle}));
  };
  CObservationOdometry fast = odometryAt(12.7, {0, 0, 0});
  fast.hasVelocities = true;
  fast.velocityLocal = mrpt::math::TTwist2D(7, 1, 0.5);
  const std::string path =
      folder.write("a.rawlog", onCircle(10.0) + onCircle(10.2) + onCircle(10.2) + onCircle(10.6) +
                                   onCircle(12.0) + onCircle(12.5) + bytesOf(fast) + scanBytes(13));
  const auto frames = framesOf(path);
  ASSERT_EQ(1U, frames.size());
  const auto& wheels = frames[0].wheels;
  ASSERT_EQ(4U, wheels.size());
  const std::vector<double> stamps{10.1, 10.4, 12.25};
  for (std::size_t i = 0; i < stamps.size(); ++i)
  {
    EXPECT_NEAR(stamps[i], wheels[i].stamp, stamp_error);
    EXPECT_NEAR(5, wheels[i].forward_speed, 1e-5);
    EXPECT_NEAR(0.25, wheels[i].yaw_rate, 1e-6);
  }
  EXPECT_NEAR(12.7, wheels[3].stamp, stamp_error);
  EXPECT_EQ(7, wheels[3].forward_speed);
  EXPECT_EQ(0.5, wheels[3].yaw_rate);
}

/** Drivers that fill in the pose alone. */
TEST(MotionSampleReader, DisplacementsReplaceVelocitiesThatAreAllZero)
{
  const TestFolder folder;
  const auto moving = [](double stamp)
  {
    CObservationOdometry odometry = odometryAt(stamp, {4 * stamp, 0, 0});
    odometry.hasVelocities = true;
    return bytesOf(odometry);
  };
  const auto frames =
      framesOf(folder.write("a.rawlog", moving(12.5) + moving(12.75) + moving(13) + scanBytes(13)));
  ASSERT_EQ(1U, frames.size());
  ASSERT_EQ(2U, frames[0].wheels.size());
  EXPECT_NEAR(12.625, frames[0].wheels[0].stamp, stamp_error);
  EXPECT_NEAR(4, frames[0].wheels[0].forward_speed, 1e-5);
}

TEST(MotionSampleReader, VelocitiesThatAreNotFiniteAreLeftOut)
{
  const TestFolder folder;
  CObservationOdometry odometry = odometryAt(12.5, {0, 0, 0});
  odometry.hasVelocities = true;
  odometry.velocityLocal.vx = std::numeric_limits<double>::quiet_NaN();
  CObservationOdometry good = odometryAt(12.6, {0, 0, 0});
  good.hasVelocities = true;
  good.velocityLocal.vx = 3;
  const auto frames =
      framesOf(folder.write("a.rawlog", bytesOf(odometry) + bytesOf(good) + scanBytes(13)));
  ASSERT_EQ(1U, frames.at(0).wheels.size());
  EXPECT_EQ(3, frames[0].wheels[0].forward_speed);
}

TEST(MotionSampleReader, SamplesFarAheadDoNotHideThoseBehindThem)
{
  const TestFolder folder;
  CObservationOdometry wheels = odometryAt(99.9, {0, 0, 0});
  wheels.hasVelocities = true;
  wheels.velocityLocal.vx = 1;
  CObservationOdometry ahead = wheels;
  ahead.timestamp = mrpt::Clock::fromDouble(102);
  const std::string path =
      folder.write("a.rawlog", bytesOf(imuAt(99.95)) + bytesOf(imuAt(109)) + bytesOf(imuAt(99.97)) +
                                   bytesOf(ahead) + bytesOf(wheels) + scanBytes(100) +
                                   bytesOf(imuAt(100.05)) + scanBytes(100.1));
  const auto frames = framesOf(path);
  ASSERT_EQ(2U, frames.size());
  ASSERT_EQ(2U, frames[0].imu.size());
  EXPECT_NEAR(99.97, frames[0].imu[1].stamp, stamp_error);
  ASSERT_EQ(1U, frames[0].wheels.size());
  EXPECT_NEAR(99.9, frames[0].wheels[0].stamp, stamp_error);
  EXPECT_EQ(1U, frames[1].imu.size());
  EXPECT_EQ("", linesOf(path));
}

TEST(MotionSampleReader, OneSensorOfAKindIsChosenByItsLabel)
{
  const TestFolder folder;
  CObservationIMU other = imuAt(99.95);
  other.sensorLabel = "imu_rear";
  CObservationOdometry wheels = odometryAt(99.9, {0, 0, 0});
  wheels.hasVelocities = true;
  wheels.velocityLocal.vx = 1;
  CObservationOdometry second = wheels;
  second.sensorLabel = "visual";
  second.velocityLocal.vx = 2;
  const std::string path =
      folder.write("a.rawlog", bytesOf(imuAt(99.9)) + bytesOf(other) + bytesOf(wheels) +
                                   bytesOf(second) + bytesOf(other) + scanBytes(100));
  EXPECT_NEAR(99.9, framesOf(path).at(0).imu.at(0).stamp, stamp_error);
  EXPECT_EQ(1, framesOf(path).at(0).wheels.at(0).forward_speed);
  const std::string told = linesOf(path);
  EXPECT_TRUE(contains(told,
                       "samples of 'imu_rear' are ignored: 'imu' came first; choose with "
                       "imu_label (2 times)"))
      << told;
  EXPECT_TRUE(contains(told,
                       "'visual' are ignored: 'odometry' came first; choose with "
                       "odometry_label"))
      << told;

  RawlogSourceOptions options;
  options.imu_label = ".*_rear";
  options.odometry_label = "visual";
  const auto frames = framesOf(path, options);
  ASSERT_EQ(1U, frames.at(0).imu.size());
  EXPECT_NEAR(99.95, frames[0].imu[0].stamp, stamp_error);
  EXPECT_EQ(2, frames[0].wheels.at(0).forward_speed);
  EXPECT_EQ("", linesOf(path, options));

  options.odometry_label = "legs";
  EXPECT_TRUE(framesOf(path, options).at(0).wheels.empty());
  EXPECT_TRUE(contains(linesOf(path, options),
                       "odometry_label = legs matches the label of no such sensor"));
  options.imu_label = "(";
  const auto said = messageOfError<UserError>([&] { RawlogSource(path, options); });
  EXPECT_TRUE(contains(said, "imu_label = ( is not a regular expression")) << said;
}

TEST(MotionSampleReader, AClockThatIsSetBackIsBridged)
{
  const TestFolder folder;
  for (const double step : {2.0, 0.5})
  {
    writeSensedDrive(folder.file("a.rawlog"), 20, step, 10);
    const auto frames = framesOf(folder.file("a.rawlog"));
    ASSERT_EQ(17U, frames.size());
    double before = 0;
    for (const Frame& frame : frames)
    {
      // Three scans are dropped before the step shows; their samples go to the fourth.
      const bool is_first_behind = frame.index == 13;
      EXPECT_EQ(is_first_behind ? 20U : 5U, frame.imu.size()) << frame.index;
      EXPECT_EQ(is_first_behind ? 8U : 2U, frame.wheels.size()) << frame.index;
      for (const ImuSample& sample : frame.imu)
      {
        EXPECT_GT(sample.stamp, before);
        before = sample.stamp;
      }
      ASSERT_FALSE(frame.imu.empty());
      EXPECT_NEAR(frame.scan.stamp, frame.imu.back().stamp, stamp_error);
      EXPECT_NEAR(frame.scan.stamp, frame.wheels.back().stamp, stamp_error);
    }
  }
}

TEST(MotionSampleReader, SamplesOfSkippedScansGoToTheNextOne)
{
  const TestFolder folder;
  writeSensedDrive(folder.file("a.rawlog"), 160);
  RawlogSourceOptions options;
  options.skip_first_n = 2;
  auto frames = framesOf(folder.file("a.rawlog"), options);
  ASSERT_EQ(158U, frames.size());
  EXPECT_EQ(15U, frames[0].imu.size());
  EXPECT_EQ(5U, frames[1].imu.size());
  options.skip_first_n = 150;
  frames = framesOf(folder.file("a.rawlog"), options);
  ASSERT_EQ(10U, frames.size());
  EXPECT_NEAR(frames[0].scan.stamp - 10, frames[0].imu.at(0).stamp, 0.021);
  EXPECT_NEAR(frames[0].scan.stamp, frames[0].imu.back().stamp, stamp_error);
  EXPECT_EQ(5U, frames[1].imu.size());
  EXPECT_EQ("", linesOf(folder.file("a.rawlog"), options));
}

TEST(MotionSampleReader, SamplesOfAnotherClockAreIgnoredWithAWarning)
{
  const TestFolder folder;
  const std::string path =
      folder.write("a.rawlog", bytesOf(imuAt(5)) + scanBytes(100) + bytesOf(imuAt(5.1)) +
                                   scanBytes(100.1) + bytesOf(imuAt(100.15)) + scanBytes(100.2));
  const auto frames = framesOf(path);
  ASSERT_EQ(3U, frames.size());
  EXPECT_TRUE(frames[0].imu.empty());
  EXPECT_TRUE(frames[1].imu.empty());
  EXPECT_EQ(1U, frames[2].imu.size());
  const std::string told = linesOf(path);
  EXPECT_TRUE(contains(told,
                       "samples of 'imu' are ignored: their times are more than 10 s before or "
                       "1 s after those of the scans (2 times)"))
      << told;
}
}  // namespace dyslam
