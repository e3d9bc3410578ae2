// SPDX-License-Identifier: BSD-3-Clause
// Samples of IMUs and wheels that RawlogWriter writes.
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/io/RawlogStream.h>
#include <dyslam/io/RawlogWriter.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "MotionBytes.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
TEST(RawlogWriterMotion, AddsTheSpeedsOfWheelsUp)
{
  const TestFolder folder;
  {
    RawlogWriter writer(folder.file("a.rawlog"));
    for (int i = 0; i <= 50; ++i)
    {
      writer.write(WheelSample{100 + 0.02 * i, 2, 0.5});
    }
    writer.write(test::imuSample(101));
    writer.write(someScan(20, 5));
    writer.close();
  }
  RawlogStream stream(folder.file("a.rawlog"));
  mrpt::obs::CObservationOdometry::Ptr last;
  std::string imu_label;
  while (const auto observation = stream.next())
  {
    const auto odometry = std::dynamic_pointer_cast<mrpt::obs::CObservationOdometry>(observation);
    last = odometry ? odometry : last;
    imu_label = dynamic_cast<const mrpt::obs::CObservationIMU*>(observation.get()) != nullptr
                    ? observation->sensorLabel
                    : imu_label;
  }
  EXPECT_EQ("imu", imu_label);
  ASSERT_TRUE(last);
  EXPECT_EQ("odometry", last->sensorLabel);
  EXPECT_EQ(2, last->velocityLocal.vx);
  EXPECT_EQ(0, last->velocityLocal.vy);
  EXPECT_NEAR(4 * std::sin(0.5), last->odometry.x(), 1e-6);
  EXPECT_NEAR(4 * (1 - std::cos(0.5)), last->odometry.y(), 1e-6);
  EXPECT_NEAR(0.5, last->odometry.phi(), 1e-6);
}

TEST(RawlogWriterMotion, ContinuesFromItsState)
{
  const TestFolder folder;
  const auto write = [](RawlogWriter& writer, std::size_t from)
  {
    for (std::size_t i = from; i < from + 3; ++i)
    {
      const Scan scan = someScan(i, 5);
      writer.write(WheelSample{scan.stamp, 1 + static_cast<double>(i), 0.3});
      writer.write(test::imuSample(scan.stamp));
      writer.write(scan);
    }
  };
  RawlogWriter whole(folder.file("a.rawlog"));
  write(whole, 0);
  StateArchive archive;
  whole.saveState(archive);
  folder.write("b.rawlog.tmp", folder.read("a.rawlog.tmp"));
  StateArchive saved(archive.bytes());
  RawlogWriter continued(folder.file("b.rawlog"), {}, saved);
  saved.requireEnd();
  write(whole, 3);
  write(continued, 3);
  whole.close();
  continued.close();
  EXPECT_EQ(folder.read("a.rawlog"), folder.read("b.rawlog"));
}

TEST(RawlogWriterMotion, RefusesSamplesWithoutTime)
{
  const TestFolder folder;
  RawlogWriter writer(folder.file("a.rawlog"));
  EXPECT_THROW(writer.write(test::imuSample(std::numeric_limits<double>::quiet_NaN())), UserError);
  EXPECT_THROW(writer.write(WheelSample{1e12, 0, 0}), UserError);
  writer.write(someScan(0, 5));
  writer.close();
  EXPECT_THROW(writer.write(test::imuSample(100)), std::logic_error);
}
}  // namespace dyslam
