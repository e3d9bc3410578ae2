// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>

#include <cmath>
#include <limits>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

Scan someScan(std::size_t number, std::size_t points)
{
  Scan scan;
  scan.stamp = 100.0 + 0.1 * static_cast<double>(number);
  for (std::size_t i = 0; i < points; ++i)
  {
    const auto value = static_cast<float>(i);
    scan.points.emplace_back(value + 0.25F, -value, static_cast<float>(number));
    scan.intensity.push_back(static_cast<float>(i % 100) / 100.0F);
  }
  scan.T_vehicle_lidar = poseFromYpr(1, 0.5, 1.7, 0.1, -0.05, 0.02);
  scan.sensor_label = "velodyne";
  return scan;
}

Pose somePose(std::size_t number)
{
  const auto n = static_cast<double>(number);
  return poseFromYpr(n, 0.1 * n, -0.01 * n, 0.02 * n, 0.01 * n, -0.005 * n);
}

void writeScans(const std::string& path, std::size_t count, const RawlogWriterOptions& options = {})
{
  RawlogWriter writer(path, options);
  for (std::size_t i = 0; i < count; ++i)
  {
    writer.write(someScan(i, 50 + i), somePose(i));
  }
  writer.close();
}

void expectSamePoints(const Scan& expected, const Scan& scan)
{
  ASSERT_EQ(expected.size(), scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      const float a = expected.points[i][k];
      const float b = scan.points[i][k];
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i << ": " << a << " " << b;
    }
  }
}
}  // namespace

class RawlogRoundTrip : public ::testing::TestWithParam<bool>
{
};

TEST_P(RawlogRoundTrip, KeepsEverything)
{
  const TestFolder folder;
  RawlogWriterOptions options;
  options.external_storage = GetParam();
  writeScans(folder.file("a.rawlog"), 5, options);
  EXPECT_EQ(GetParam(), std::filesystem::exists(folder.file("a_Images")));

  RawlogSource source(folder.file("a.rawlog"));
  for (std::size_t i = 0; i < 5; ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    const Scan expected = someScan(i, 50 + i);
    EXPECT_EQ(i, frame->index);
    EXPECT_EQ(expected.stamp, frame->scan.stamp);
    EXPECT_EQ("velodyne", frame->scan.sensor_label);
    expectSamePoints(expected, frame->scan);
    EXPECT_EQ(expected.intensity, frame->scan.intensity);
    EXPECT_TRUE(frame->scan.time.empty());
    EXPECT_TRUE(frame->scan.ring.empty());
    EXPECT_TRUE(frame->scan.T_vehicle_lidar.isApprox(expected.T_vehicle_lidar, 1e-12));
    ASSERT_TRUE(frame->T_world_vehicle_truth);
    EXPECT_TRUE(frame->T_world_vehicle_truth->isApprox(somePose(i), 1e-12));
  }
  EXPECT_FALSE(source.next());
  EXPECT_EQ(5U, source.framesRead());
  EXPECT_DOUBLE_EQ(1.0, source.progress());
  EXPECT_TRUE(source.warnings().empty());
}
INSTANTIATE_TEST_SUITE_P(Storage, RawlogRoundTrip, ::testing::Bool());
}  // namespace dyslam
