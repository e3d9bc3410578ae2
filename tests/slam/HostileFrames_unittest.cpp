// SPDX-License-Identifier: BSD-3-Clause
// The whole pipeline on scans and sensors with numbers that nothing measures.
#include <dyslam/base/Config.h>
#include <dyslam/core/FrameCopy.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/pipeline/Pipeline.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "SimulatedFrames.h"

namespace dyslam
{
namespace
{
constexpr std::size_t scan_count = 30;
constexpr std::size_t first_useless = 12;  // number of the first of four scans without a scene
constexpr std::size_t after_gap = 20;      // number of the first scan after a gap of two days

/** Every fortieth point gets coordinates, an intensity and a ring, and the next one a time, that no
 * sensor measures. */
void spoilPoints(std::size_t shift, Scan& scan)
{
  constexpr std::array<float, 8> wild{NAN, INFINITY, -INFINITY, 1e5F, -1e9F, 1e30F, -3e38F, 1e-42F};
  for (std::size_t n = 0; 40 * n + shift < scan.size(); ++n)
  {
    const std::size_t i = 40 * n + shift;
    const float value = wild[n % wild.size()];
    scan.points[i] = {n % 2 == 0 ? value : -0.0F, n % 3 == 0 ? value : -0.0F, value};
    scan.intensity[i] = value;
    scan.time.at(i + 1 < scan.size() ? i + 1 : i) = value;
    scan.ring[i] = 65535;
  }
}

void keepPoints(std::size_t count, Scan& scan)
{
  scan.points.resize(count);
  scan.intensity.resize(count);
  scan.time.resize(count);
  scan.ring.resize(count);
}

/** Makes a scan empty, one point, all points equal, or one ring. */
void makeUseless(std::size_t kind, Scan& scan)
{
  switch (kind)
  {
    case 0:
      keepPoints(0, scan);
      break;
    case 1:
      keepPoints(1, scan);
      break;
    case 2:
      scan.points.assign(scan.size(), {5, 1, 0});
      break;
    default:
      for (std::size_t i = 0; i < scan.size(); ++i)
      {
        scan.points[i] *= scan.ring[i] == 8 ? 1.0F : 0.0F;
      }
  }
}

void spoilSensors(std::size_t shift, Frame& frame)
{
  constexpr std::array<double, 4> wild{NAN, 1e200, -1.7e308, 1e38};
  const double value = wild[shift % wild.size()];
  if (!frame.imu.empty() && !frame.wheels.empty())  // as before the first scan
  {
    frame.imu.front().angular_velocity.y() = value;
    frame.imu.back().acceleration = Eigen::Vector3d(0, value, 9.81);
    frame.wheels.back().forward_speed = value;
  }
  GnssFix fix;
  fix.stamp = frame.scan.stamp;
  fix.position = {value, 8, 100};
  frame.gnss.push_back(fix);
}

void delay(double time, Frame& frame)
{
  frame.scan.stamp += time;
  for (ImuSample& sample : frame.imu)
  {
    sample.stamp += time;
  }
  for (WheelSample& sample : frame.wheels)
  {
    sample.stamp += time;
  }
}

std::vector<Frame> hostileFrames()
{
  sim::SimulatorOptions options;
  options.sensor = sim::SensorKind::vlp16;
  options.columns = 600;
  options.traffic = 0.3;
  options.seed = 5;
  options.imu = true;
  options.wheels = true;
  std::vector<Frame> frames = test::simulatedFrames(options, scan_count);
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    delay(i < after_gap ? 0 : 2 * 86400, frames[i]);
    spoilSensors(i, frames[i]);
    if (i >= first_useless && i < first_useless + 4)
    {
      makeUseless(i - first_useless, frames[i].scan);
    }
    spoilPoints(i, frames[i].scan);
  }
  return frames;
}

bool areProbabilities(const std::vector<float>& values)
{
  return std::all_of(values.begin(), values.end(), [](float p) { return p >= 0 && p <= 1; });
}

/** Poses, points, objects and map are as of sound scans. */
void expectSoundResults(const Config& config)
{
  ConfigLoader loader(config);
  mrpt::system::CTimeLogger times(false);
  Pipeline pipeline(loader, times);
  std::size_t final_frames = 0;
  pipeline.onFinal(
      [&](const Frame& frame)
      {
        ++final_frames;
        EXPECT_TRUE(areProbabilities(frame.moving_probability));
        for (const TrackedObject& object : frame.objects)
        {
          EXPECT_LT(object.box.centre.norm(), 200);
          EXPECT_LT(object.box.size.norm(), 50);
        }
      },
      FrameParts::all);
  const std::vector<Frame> frames = hostileFrames();
  for (Frame frame : frames)
  {
    pipeline.process(frame);
    const Pose truth =
        frames.front().T_world_vehicle_truth->inverse() * *frame.T_world_vehicle_truth;
    EXPECT_LT((truth.translation() - frame.T_odom_vehicle.translation()).norm(), 1.0)
        << "scan " << frame.index;
    for (const Eigen::Vector3f& p : frame.cloud.points)
    {
      ASSERT_LT(p.norm(), 300) << "scan " << frame.index;
    }
  }
  pipeline.finish();
  EXPECT_EQ(final_frames, frames.size());
  const MapPoints map = pipeline.map()->points();
  EXPECT_GT(map.size(), 1000U);
  for (const Eigen::Vector3f& p : map.points)
  {
    ASSERT_LT(p.norm(), 300);
  }
}

TEST(HostileFrames, LeaveSoundResults)
{
  for (const auto& [segmenter, matcher] :
       {std::pair("network", "constant_velocity"), std::pair("residual", "loam")})
  {
    SCOPED_TRACE(std::string(segmenter) + " " + matcher);
    Config config;
    config.set("dyseg.method=" + std::string(segmenter));
    config.set("odometry.method=" + std::string(matcher));
    config.set("labels.window=6");
    config.set("gravity.use=fuse");
    config.set("gnss.use=fuse");
    expectSoundResults(config);
  }
}
}  // namespace
}  // namespace dyslam
