// SPDX-License-Identifier: BSD-3-Clause
// Observations of motion sensors in every version of MRPT's, and damaged ones.
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogStream.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "MotionBytes.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using test::bytesOf;

mrpt::obs::CObservationOdometry movingWheels(double stamp)
{
  auto wheels = test::odometryAt(stamp, {1, 2, 3});
  wheels.hasEncodersInfo = true;
  wheels.encoderLeftTicks = 4;
  wheels.hasVelocities = true;
  wheels.velocityLocal = mrpt::math::TTwist2D(5, 0, 0.5);
  return wheels;
}

/** The samples of the first frame, after a motion sensor's bytes and a good sample of each kind at
 * 99.9 s; the second frame must come, too. */
Frame firstFrame(const TestFolder& folder, const std::string& bytes)
{
  const std::string path =
      folder.write("a.rawlog", bytes + bytesOf(test::imuAt(99.9)) + bytesOf(movingWheels(99.9)) +
                                   test::scanBytes(100) + bytes + test::scanBytes(101));
  const auto frames = readAll(path);
  EXPECT_EQ(2U, frames.size());
  return frames.empty() ? Frame() : frames.front();
}
}  // namespace

TEST(ObjectLayoutMotion, ObservationsAreReadAsMrptWritesThem)
{
  const TestFolder folder;
  auto imu = test::imuAt(100);
  imu.sensorPose = mrpt::poses::CPose3D(1, 2, 3, 0.1, 0.2, 0.3);
  imu.set(mrpt::obs::IMU_Z_ACC_GLOBAL, 9);
  auto bare = test::odometryAt(100, {1, 2, 3});
  auto encoders = bare;
  encoders.hasEncodersInfo = true;
  auto velocities = bare;
  velocities.hasVelocities = true;
  const auto both = movingWheels(100);
  for (const std::string& bytes :
       {bytesOf(imu), bytesOf(bare), bytesOf(encoders), bytesOf(velocities), bytesOf(both)})
  {
    RawlogStream stream(folder.write("a.rawlog", bytes + bytes));
    for (int i = 0; i < 2; ++i)
    {
      const auto read = stream.next();
      ASSERT_TRUE(read);
      EXPECT_EQ(bytes, bytesOf(*read));
    }
    EXPECT_FALSE(stream.next());
  }
}

TEST(ObjectLayoutMotion, SensoryFramesMayHoldThem)
{
  const TestFolder folder;
  mrpt::obs::CSensoryFrame frame;
  frame.insert(std::make_shared<mrpt::obs::CObservationIMU>(test::imuAt(99.9)));
  frame.insert(std::make_shared<mrpt::obs::CObservationOdometry>(movingWheels(99.9)));
  const std::string path = folder.write("a.rawlog", bytesOf(frame) + test::scanBytes(100));
  const auto frames = readAll(path);
  ASSERT_EQ(1U, frames.size());
  EXPECT_EQ(1U, frames[0].imu.size());
  EXPECT_EQ(1U, frames[0].wheels.size());
}

TEST(ObjectLayoutMotion, OlderVersionsAreRead)
{
  const TestFolder folder;
  const auto imu = test::imuAt(99.8);
  for (const int version : {1, 2, 3})
  {
    const Frame frame = firstFrame(folder, test::olderImu(imu, version));
    ASSERT_EQ(2U, frame.imu.size()) << version;
    // MRPT exchanges x and z of version 1, which recorded them the wrong way round.
    EXPECT_EQ(version == 1 ? 0.3 : 0.1, frame.imu[0].angular_velocity.x()) << version;
    EXPECT_EQ(0.2, frame.imu[0].angular_velocity.y()) << version;
  }
  Frame frame = firstFrame(folder, test::olderOdometry(movingWheels(99.8), 1, 2.5F, 0.25F));
  ASSERT_EQ(2U, frame.wheels.size());
  EXPECT_EQ(2.5, frame.wheels[0].forward_speed);
  EXPECT_EQ(0.25, frame.wheels[0].yaw_rate);
  frame = firstFrame(folder, test::olderOdometry(test::odometryAt(99.6, {1, 1, 0}), 0) +
                                 test::olderOdometry(test::odometryAt(99.8, {2, 1, 0}), 0));
  ASSERT_EQ(2U, frame.wheels.size());
  EXPECT_NEAR(5, frame.wheels[0].forward_speed, 1e-5);
}

TEST(ObjectLayoutMotion, OtherVersionsAreSkipped)
{
  const TestFolder folder;
  for (const int version : {0, 5, 100})
  {
    const Frame frame =
        firstFrame(folder, test::withVersion(bytesOf(test::imuAt(99.8)), version) +
                               test::withVersion(bytesOf(movingWheels(99.8)), 3 + version));
    EXPECT_EQ(1U, frame.imu.size()) << version;
    EXPECT_EQ(1U, frame.wheels.size()) << version;
  }
}

TEST(ObjectLayoutMotion, DamagedOnesAreSkipped)
{
  const TestFolder folder;
  const auto imu = test::imuAt(99.8);
  for (const std::uint32_t count : {32U, 1000U, 0xFFFFFFFFU})
  {
    EXPECT_EQ(1U, firstFrame(folder, test::olderImu(imu, 3, count)).imu.size()) << count;
    EXPECT_EQ(1U, firstFrame(folder, test::olderImu(imu, 3, 31, count)).imu.size()) << count;
  }
  // Of the label: the last part of an IMU's observation.
  for (const std::uint32_t length : {0U, 2U, 200U, 60000U, 0xFFFFFFFFU})
  {
    std::string bytes = bytesOf(imu);
    bytes.replace(bytes.size() - 8, 4, test::numberBytes(length));
    EXPECT_EQ(1U, firstFrame(folder, bytes).imu.size()) << length;
  }
  const std::string wheels = bytesOf(movingWheels(99.8));
  std::string damaged = wheels;
  damaged.replace(wheels.find("odometry") - 4, 4, test::numberBytes(0x7FFFFFFFU));
  EXPECT_EQ(1U, firstFrame(folder, damaged).wheels.size());
  EXPECT_EQ(2U, firstFrame(folder, wheels).wheels.size());
}

TEST(ObjectLayoutMotion, OneThatIsCutShortIsAnError)
{
  const TestFolder folder;
  const std::string bytes = bytesOf(test::imuAt(99.9));
  for (std::size_t size = 1; size < bytes.size(); size += 7)
  {
    RawlogSource source(folder.write("a.rawlog", test::scanBytes(100) + bytes.substr(0, size)));
    EXPECT_TRUE(source.next()) << size;
    EXPECT_THROW((void)source.next(), UserError) << size;
  }
}
}  // namespace dyslam
