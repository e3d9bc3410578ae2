// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/dyseg/ResidualSegmenter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
/** Rays of a 32-beam lidar 1.7 m above ground between walls at y = +-15, with a 4 x 1.8 x 1.5 m
 * body. */
Frame scene(const Pose& T_odom_vehicle, const Eigen::Vector2d& body)
{
  Frame frame;
  frame.T_odom_vehicle = T_odom_vehicle;
  const Eigen::Vector3d origin = T_odom_vehicle.translation();
  for (int beam = 0; beam < 32; ++beam)
  {
    for (int step = 0; step < 900; ++step)
    {
      const double elevation = (-20 + beam * 0.8) * M_PI / 180;
      const double azimuth = step * 2 * M_PI / 900;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Eigen::Vector3d direction = T_odom_vehicle.linear() * ray;
      double range = 80;
      const auto hit = [&](double t) { range = t > 0.5 ? std::min(range, t) : range; };
      hit((-1.7 - origin.z()) / direction.z());
      hit((15 - origin.y()) / direction.y());
      hit((-15 - origin.y()) / direction.y());
      double enter = 0;
      double leave = 1e9;
      const Eigen::Vector3d low(body.x() - 2, body.y() - 0.9, -1.7);
      const Eigen::Vector3d high(body.x() + 2, body.y() + 0.9, -0.2);
      for (int axis = 0; axis < 3; ++axis)
      {
        const double a = (low[axis] - origin[axis]) / direction[axis];
        const double b = (high[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave)
      {
        hit(enter);
      }
      if (range < 79)
      {
        frame.cloud.points.push_back((ray * range).cast<float>());
      }
    }
  }
  return frame;
}

struct Counts
{
  int found = 0;
  int body = 0;
  int wrong = 0;
  int other = 0;
};

Counts count(const Frame& frame, const Eigen::Vector2d& body)
{
  Counts counts;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    const Eigen::Vector3d p = frame.T_odom_vehicle * frame.cloud.points[i].cast<double>();
    const bool on_body =
        std::abs(p.x() - body.x()) < 2.05 && std::abs(p.y() - body.y()) < 0.95 && p.z() > -1.65;
    const bool moving = frame.moving_probability[i] > 0.5F;
    (on_body ? counts.body : counts.other)++;
    if (moving)
    {
      (on_body ? counts.found : counts.wrong)++;
    }
  }
  return counts;
}

Counts drive(double body_speed, int threads = 1)
{
  ThreadPool pool(threads);
  ResidualSegmenter segmenter(ResidualSegmenterOptions(), pool);
  Frame frame;
  Eigen::Vector2d body(12, 4);
  for (int k = 0; k < 14; ++k)
  {
    body = {12 + 0.1 * body_speed * k, 4};
    frame = scene(poseFromYpr(0.8 * k, 0, 0, 0.01 * k, 0, 0), body);
    segmenter.segment(frame);
  }
  return count(frame, body);
}

TEST(ResidualSegmenter, FindsTheMoverAndNothingElse)
{
  const Counts counts = drive(-8);
  ASSERT_GT(counts.body, 100);
  EXPECT_GT(counts.found, 0.7 * counts.body);
  EXPECT_LT(counts.wrong, 0.002 * counts.other);
}

TEST(ResidualSegmenter, AStandingBodyIsStatic)
{
  const Counts counts = drive(0);
  ASSERT_GT(counts.body, 100);
  EXPECT_EQ(counts.found, 0);
  EXPECT_EQ(counts.wrong, 0);
}

/** scene() of two lidars on a wide vehicle, 6 m beside each other. */
Frame sceneOfTwo(const Pose& T_odom_vehicle, const Eigen::Vector2d& body)
{
  const Pose right(Eigen::Translation3d(0, -3, 0));
  const Pose left(Eigen::Translation3d(0, 3, 0));
  Frame frame = scene(T_odom_vehicle * right, body);
  const Frame further = scene(T_odom_vehicle * left, body);
  frame.T_odom_vehicle = T_odom_vehicle;
  frame.scan.T_vehicle_lidar = right;
  ScanPart part;
  part.begin = frame.cloud.size();
  part.T_scan_lidar = right.inverse() * left;
  frame.scan.parts = {part};
  for (auto& p : frame.cloud.points)
  {
    p = right.cast<float>() * p;
  }
  for (const auto& p : further.cloud.points)
  {
    frame.cloud.points.emplace_back(left.cast<float>() * p);
  }
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
  }
  frame.scan.points = frame.cloud.points;
  return frame;
}

TEST(ResidualSegmenter, RaysOfTwoLidarsStartAtEach)
{
  for (const double speed : {-8.0, 0.0})
  {
    ThreadPool pool(2);
    ResidualSegmenter segmenter(ResidualSegmenterOptions(), pool);
    Frame frame;
    Eigen::Vector2d body;
    for (int k = 0; k < 14; ++k)
    {
      body = {12 + 0.1 * speed * k, 4};
      frame = sceneOfTwo(poseFromYpr(0.8 * k, 0, 0, 0.01 * k, 0, 0), body);
      segmenter.segment(frame);
    }
    const Counts counts = count(frame, body);
    ASSERT_GT(counts.body, 200);
    EXPECT_GE(counts.found, speed == 0 ? 0 : 0.7 * counts.body);
    EXPECT_LE(counts.wrong, speed == 0 ? 0 : 0.002 * counts.other);
  }
}

/** Rays of a 16-beam lidar 1 m above open ground with an upright 0.8 x 0.8 x 2.2 m body. */
Frame openScene(const Eigen::Vector2d& body)
{
  Frame frame;
  for (int beam = 0; beam < 16; ++beam)
  {
    for (int step = 0; step < 900; ++step)
    {
      const double slope = std::tan((-15 + 2 * beam) * M_PI / 180);
      const double azimuth = (step + 0.5) * 2 * M_PI / 900;
      const Eigen::Vector3d ray(std::cos(azimuth), std::sin(azimuth), slope);
      const Eigen::Vector2d side(-ray.y(), ray.x());
      const double distance = body.dot(ray.head<2>()) - 0.4;
      const bool met = distance > 0 && std::abs(body.dot(side)) < 0.4 && distance * slope < 1.2 &&
                       distance * slope > -1;
      const double range = met ? distance : slope < 0 ? -1 / slope : 1e9;
      if (range < 60)
      {
        frame.cloud.points.push_back((ray * range).cast<float>());
      }
    }
  }
  return frame;
}

int movingPoints(double speed, bool open_sky, const Pose& T_vehicle_lidar = Pose::Identity())
{
  ThreadPool pool(1);
  ResidualSegmenterOptions options;
  options.slope_bin = 0.028;
  options.azimuth_bin = 0.0105;
  options.open_sky = open_sky;
  ResidualSegmenter segmenter(options, pool);
  Frame frame;
  for (int k = 0; k < 14; ++k)
  {
    frame = openScene({8, 0.1 * speed * k});
    frame.scan.T_vehicle_lidar = T_vehicle_lidar;
    segmenter.segment(frame);
  }
  return static_cast<int>(std::count_if(frame.moving_probability.begin(),
                                        frame.moving_probability.end(),
                                        [](float p) { return p > 0.5F; }));
}

TEST(ResidualSegmenter, RaysIntoTheOpenSkyPassAFewBeamsBody)
{
  const int with = movingPoints(1.4, true), without = movingPoints(1.4, false);
  EXPECT_GT(with, 60);
  EXPECT_GT(with, without);
  EXPECT_EQ(movingPoints(0, true), 0);
}

TEST(ResidualSegmenter, TheSkyIsAboveALidarUpsideDown)
{
  EXPECT_NEAR(movingPoints(1.4, true, poseFromYpr(0, 0, 0, 0, 0, M_PI)), movingPoints(1.4, true),
              10);
}

TEST(ResidualSegmenter, SameAnswerForAnyThreadCount)
{
  EXPECT_EQ(drive(-8, 1).found, drive(-8, 3).found);
}

TEST(ResidualSegmenter, PointsThatAreNotFiniteChangeNothing)
{
  ThreadPool pool(1);
  ResidualSegmenter segmenter(ResidualSegmenterOptions(), pool);
  ResidualSegmenter with_invalid(ResidualSegmenterOptions(), pool);
  Frame frame;
  Frame invalid;
  for (int k = 0; k < 14; ++k)
  {
    frame = scene(poseFromYpr(0.8 * k, 0, 0, 0.01 * k, 0, 0), {12 - 0.8 * k, 4});
    invalid = frame;
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    {
      invalid.cloud.points.emplace_back(value, value, value);
      invalid.cloud.points.emplace_back(5, value, 0);
      invalid.cloud.points.emplace_back(5, 0, value);
    }
    segmenter.segment(frame);
    with_invalid.segment(invalid);
  }
  ASSERT_EQ(invalid.moving_probability.size(), frame.moving_probability.size() + 6);
  for (std::size_t i = frame.moving_probability.size(); i < invalid.moving_probability.size(); ++i)
  {
    EXPECT_LT(invalid.moving_probability[i], 0.5F);
  }
  invalid.moving_probability.resize(frame.moving_probability.size());
  EXPECT_EQ(invalid.moving_probability, frame.moving_probability);
}

TEST(ResidualSegmenter, EmptyAndSinglePointFramesAreFine)
{
  ThreadPool pool(1);
  ResidualSegmenter segmenter(ResidualSegmenterOptions(), pool);
  Frame frame;
  segmenter.segment(frame);
  EXPECT_TRUE(frame.moving_probability.empty());
  frame.cloud.points.emplace_back(5, 0, 0);
  segmenter.segment(frame);
  segmenter.segment(frame);
  ASSERT_EQ(frame.moving_probability.size(), 1U);
  EXPECT_LT(frame.moving_probability[0], 0.5F);
}

TEST(ResidualSegmenter, BadOptionsAreNamed)
{
  ThreadPool pool(1);
  ResidualSegmenterOptions options;
  options.cell_size = 0;
  EXPECT_THROW(ResidualSegmenter(options, pool), UserError);
}
}  // namespace
}  // namespace dyslam
