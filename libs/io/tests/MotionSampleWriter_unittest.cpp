// SPDX-License-Identifier: BSD-3-Clause
// Samples of other sensors that a converter writes between the scans.
#include "../src/conversion/MotionSampleWriter.h"

#include <dyslam/io/RawlogStream.h>
#include <gtest/gtest.h>

#include "MotionBytes.h"
#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** A rawlog of scans at given times, with the samples that wait before each. */
class SampledOutput
{
 public:
  void writeScan(double stamp)
  {
    samples.writeUpTo(stamp, output_);
    Scan scan = someScan(0, 3);
    scan.stamp = stamp;
    output_.write(scan, std::nullopt);
  }

  /** The stamps of all observations in the order of the file [s]; ends the file. */
  [[nodiscard]] std::vector<double> stamps()
  {
    (void)output_.close();
    RawlogStream stream(folder_.file("x.rawlog"));
    std::vector<double> stamps;
    while (const auto observation = stream.next())
    {
      stamps.push_back(mrpt::Clock::toDouble(observation->timestamp));
    }
    return stamps;
  }

  MotionSampleWriter samples;

 private:
  TestFolder folder_;
  ConversionOutput output_{folder_.file("x.rawlog"), ConversionOptions(), PoseOrigin()};
};

void expectStamps(const std::vector<double>& expected, const std::vector<double>& stamps)
{
  ASSERT_EQ(expected.size(), stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i)
  {
    EXPECT_NEAR(expected[i], stamps[i], 1e-6) << i;
  }
}
}  // namespace

TEST(MotionSampleWriter, WritesBothKindsInOrderOfTime)
{
  SampledOutput out;
  out.samples.add(WheelSample{99.95, 1, 0});
  out.samples.add(test::imuSample(99.98));
  out.samples.add(test::imuSample(99.96));
  out.samples.add(test::imuSample(98.9));
  out.samples.add(WheelSample{100.05, 1, 0});
  out.writeScan(100);
  EXPECT_EQ(2U, out.samples.imu().samples);
  EXPECT_EQ(1U, out.samples.wheels().samples);
  out.samples.add(test::imuSample(100.02));
  out.writeScan(100.1);
  EXPECT_EQ(2U, out.samples.imu().scans);
  EXPECT_EQ(2U, out.samples.wheels().scans);
  expectStamps({99.95, 99.96, 99.98, 100, 100.02, 100.05, 100.1}, out.stamps());
}

TEST(MotionSampleWriter, LateSamplesOfUpToASecondComeWithTheNextScan)
{
  SampledOutput out;
  out.writeScan(100);
  out.samples.add(test::imuSample(99.1));
  out.samples.add(test::imuSample(98.9));
  out.writeScan(100.5);
  EXPECT_EQ(1U, out.samples.imu().samples);
  EXPECT_EQ(0U, out.samples.imu().scans);  // too old for both
  expectStamps({100, 99.1, 100.5}, out.stamps());
}

TEST(MotionSampleWriter, KnowsWhetherASampleIsAsNewAsAScan)
{
  SampledOutput out;
  out.samples.add(test::imuSample(99.9));
  out.samples.add(WheelSample{3700, 1, 0});  // a clock that is an hour ahead
  EXPECT_FALSE(out.samples.hasImuFrom(100));
  EXPECT_FALSE(out.samples.hasWheelsFrom(100));
  out.samples.add(test::imuSample(100));
  EXPECT_TRUE(out.samples.hasImuFrom(100));
  EXPECT_FALSE(out.samples.hasImuFrom(100.01));
  EXPECT_FALSE(out.samples.hasWheelsFrom(100));
}

/** An IMU whose clock is an hour ahead, or a lidar that stopped. */
TEST(MotionSampleWriter, OnlyTheLatestSamplesWait)
{
  SampledOutput out;
  out.samples.add(test::imuSample(99.5));
  for (std::size_t i = 0; i < MotionSampleWriter::most; ++i)
  {
    out.samples.add(test::imuSample(3700 + 0.01 * static_cast<double>(i)));
  }
  out.samples.add(WheelSample{99.9, 1, 0});
  out.writeScan(100);
  EXPECT_EQ(0U, out.samples.imu().samples);
  EXPECT_EQ(1U, out.samples.wheels().samples);
  expectStamps({99.9, 100}, out.stamps());
}

TEST(MotionSampleWriter, SkippedScansBeforeTheFirstDropOlderSamples)
{
  SampledOutput out;
  out.samples.add(test::imuSample(99.5));
  out.samples.skip(100.6);
  out.samples.add(test::imuSample(100.55));
  out.writeScan(100.6);
  out.samples.add(test::imuSample(100.7));
  out.samples.skip(102);
  out.writeScan(102.1);
  expectStamps({100.55, 100.6, 100.7, 102.1}, out.stamps());
}
}  // namespace dyslam
