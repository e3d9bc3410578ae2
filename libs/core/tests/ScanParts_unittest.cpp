// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/ScanParts.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace dyslam
{
namespace
{
const Pose T_vehicle_front = poseFromYpr(1, 0, 1.7, 0.1, 0, 0);
const Pose T_vehicle_rear = poseFromYpr(-2, 0.3, 0.6, M_PI, 0.05, 0);

Scan scanOf(double stamp, const Pose& mounting, std::size_t points)
{
  Scan scan;
  scan.stamp = stamp;
  scan.T_vehicle_lidar = mounting;
  for (std::size_t i = 0; i < points; ++i)
  {
    scan.points.emplace_back(1.0F + static_cast<float>(i), 2, -1);
    scan.intensity.push_back(0.1F * static_cast<float>(i));
    scan.time.push_back(0.01F * static_cast<float>(i));
    scan.ring.push_back(static_cast<std::uint16_t>(i));
  }
  return scan;
}

TEST(ScanParts, FurtherScansAreInTheFirstOnesFrameAndTime)
{
  Scan scan = scanOf(100, T_vehicle_front, 3);
  const Scan rear = scanOf(100.02, T_vehicle_rear, 2);
  appendScan(rear, 1, scan);
  ASSERT_EQ(scan.size(), 5U);
  ASSERT_EQ(scan.parts.size(), 1U);
  EXPECT_EQ(scan.parts[0].begin, 3U);
  EXPECT_NEAR(scan.parts[0].stamp, 0.02, 1e-9);
  const Eigen::Vector3d in_vehicle = T_vehicle_rear * rear.points[1].cast<double>();
  EXPECT_TRUE((T_vehicle_front * scan.points[4].cast<double>()).isApprox(in_vehicle, 1e-5));
  EXPECT_NEAR(scan.time[4], 0.03F, 1e-6F);
  EXPECT_EQ(scan.intensity[4], rear.intensity[1]);
  EXPECT_NE(scan.ring[4], scan.ring[1]);
}

TEST(ScanParts, EachPartIsAsItsLidarMeasuredIt)
{
  Scan scan = scanOf(100, T_vehicle_front, 3);
  Scan rear = scanOf(100, T_vehicle_rear, 4);
  rear.points[1].setZero();
  rear.points[2].setConstant(std::numeric_limits<float>::quiet_NaN());
  appendScan(rear, 1, scan);
  appendScan(scanOf(100.1, T_vehicle_rear, 1), 1, scan);
  ASSERT_EQ(partCount(scan), 3U);
  std::vector<Scan> parts;
  std::vector<LidarRange> ranges;
  forEachPart(scan,
              [&](const Scan& part, const LidarRange& range)
              {
                parts.push_back(part);
                ranges.push_back(range);
              });
  ASSERT_EQ(parts.size(), 3U);
  const Scan& part = parts[1];
  EXPECT_EQ(ranges[1].begin, 3U);
  EXPECT_EQ(ranges[1].end, 7U);
  EXPECT_EQ(ranges[1].lidar, 1U);
  EXPECT_TRUE(ranges[1].sensor().isApprox(T_vehicle_rear.translation().cast<float>(), 1e-5F));
  EXPECT_TRUE(ranges[1].T_vehicle_lidar.isApprox(T_vehicle_rear, 1e-9));
  EXPECT_TRUE(part.T_vehicle_lidar.isApprox(T_vehicle_rear, 1e-9));
  ASSERT_EQ(part.size(), 4U);
  EXPECT_TRUE(part.points[3].isApprox(rear.points[3], 1e-5F));
  EXPECT_TRUE(part.points[1].isZero(0)) << "no return stays none";
  EXPECT_FALSE(part.points[2].allFinite());
  EXPECT_EQ(part.time, rear.time);
  EXPECT_NEAR(ranges[2].stamp, 0.1, 1e-6);
  EXPECT_EQ(ranges[0].lidar, 0U);
  const Scan own = ownScan(scan);
  EXPECT_EQ(own.points, parts[0].points);
  EXPECT_EQ(own.points, scanOf(100, T_vehicle_front, 3).points);
  EXPECT_EQ(own.ring.size(), 3U);
  EXPECT_TRUE(own.parts.empty());
}

TEST(ScanParts, AScanOfOneLidarIsNotCopied)
{
  const Scan scan = scanOf(100, T_vehicle_front, 3);
  int parts = 0;
  forEachPart(scan,
              [&](const Scan& part, const LidarRange& range)
              {
                ++parts;
                EXPECT_EQ(&part, &scan);
                EXPECT_EQ(range.begin, 0U);
                EXPECT_EQ(range.end, 3U);
                EXPECT_TRUE(range.T_vehicle_lidar.isApprox(T_vehicle_front, 0));
              });
  EXPECT_EQ(parts, 1);
}

TEST(ScanParts, AnEmptyPartIsOneOfNoPoints)
{
  Scan scan = scanOf(100, T_vehicle_front, 3);
  appendScan(scanOf(100, T_vehicle_rear, 0), 1, scan);
  appendScan(scanOf(100, T_vehicle_rear, 2), 2, scan);
  std::vector<std::size_t> sizes;
  forEachPart(scan, [&](const Scan& part, const LidarRange&) { sizes.push_back(part.size()); });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{3, 0, 2}));
}

TEST(ScanParts, ALidarWithoutTimesLeavesThoseOfTheOthers)
{
  Scan scan = scanOf(100, T_vehicle_front, 2);
  Scan bare = scanOf(100.25, T_vehicle_rear, 2);
  bare.time.clear();
  bare.sensor_label = "bare";
  appendScan(bare, 1, scan);
  appendScan(scanOf(100.5, T_vehicle_rear, 1), 2, scan);
  EXPECT_EQ(scan.time, (std::vector<float>{0, 0.01F, 0.25F, 0.25F, 0.5F}));
  EXPECT_EQ(scan.parts[0].sensor_label, "bare");
}

TEST(ScanParts, TimesOfAFurtherLidarAloneAreNotKept)
{
  Scan bare = scanOf(100, T_vehicle_front, 2);
  bare.time.clear();
  appendScan(scanOf(100, T_vehicle_rear, 2), 1, bare);
  EXPECT_TRUE(bare.time.empty());
  Scan empty = scanOf(100, T_vehicle_front, 0);
  appendScan(scanOf(100, T_vehicle_rear, 2), 1, empty);
  EXPECT_EQ(empty.time.size(), 2U);
}

TEST(ScanParts, RingsNeedBothScans)
{
  Scan scan = scanOf(100, T_vehicle_front, 2);
  Scan bare = scanOf(100, T_vehicle_rear, 2);
  bare.ring.clear();
  bare.intensity.clear();
  appendScan(bare, 1, scan);
  EXPECT_TRUE(scan.ring.empty());
  EXPECT_EQ(scan.intensity, (std::vector<float>{0, 0.1F, 0, 0}));
}

TEST(ScanParts, ACloudIsDividedByTheSourcesOfItsPoints)
{
  Scan scan = scanOf(100, T_vehicle_front, 3);
  appendScan(scanOf(100, T_vehicle_rear, 3), 1, scan);
  appendScan(scanOf(100, T_vehicle_front, 2), 2, scan);
  Cloud cloud;
  cloud.source = {0, 2, 6};
  cloud.points.resize(3);
  const std::vector<LidarRange> ranges = lidarRanges(scan, cloud);
  ASSERT_EQ(ranges.size(), 3U);
  EXPECT_EQ(ranges[0].end, 2U);
  EXPECT_EQ(ranges[1].begin, ranges[1].end);
  EXPECT_EQ(ranges[2].begin, 2U);
  EXPECT_EQ(ranges[2].end, 3U);
  EXPECT_EQ(ranges[2].lidar, 2U);
  EXPECT_EQ(ownPoints(scan, cloud), 2U);
  Cloud without_sources;
  without_sources.points.resize(4);
  EXPECT_EQ(ownPoints(Scan(), without_sources), 4U);
  EXPECT_EQ(ownPoints(scan, without_sources), 4U);
  EXPECT_EQ(lidarRanges(scan, without_sources).back().begin, 4U);
}

TEST(ScanParts, AKeyframeKnowsTheOriginsOfAllLidars)
{
  Frame frame;
  frame.scan = scanOf(100, T_vehicle_front, 3);
  appendScan(scanOf(100, T_vehicle_rear, 3), 2, frame.scan);
  const Keyframe keyframe = keyframeOf(frame);
  EXPECT_TRUE(keyframe.sensorOf(0).isApprox(T_vehicle_front.translation().cast<float>(), 1e-5F));
  EXPECT_EQ(keyframe.sensorOf(1), keyframe.sensor) << "not in this scan";
  EXPECT_TRUE(keyframe.sensorOf(2).isApprox(T_vehicle_rear.translation().cast<float>(), 1e-5F));
  EXPECT_EQ(keyframe.sensorOf(3), keyframe.sensor);
}
}  // namespace
}  // namespace dyslam
