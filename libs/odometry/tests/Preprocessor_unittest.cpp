// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>

#include "TestScene.h"

namespace dyslam
{
namespace
{

/** Mean distance, along the rays of the sensor at the vehicle's origin, between the points of a
 * cloud and the surfaces they should lie on. */
double skewLeft(const Cloud& cloud, const test::StreetScene& scene, const Eigen::Vector3d& sensor)
{
  double sum = 0;
  std::size_t count = 0;
  for (const Eigen::Vector3f& p : cloud.points)
  {
    if (p.z() < 0.3F)
    {
      continue;  // skew moves points of the ground along the ground
    }
    const Eigen::Vector3d ray = p.cast<double>() - sensor;
    const double d = std::abs(scene.range(sensor, ray.normalized()) - ray.norm());
    if (d < 1)  // otherwise the ray passes the edge of a body
    {
      sum += d;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

TEST(Preprocessor, KeepsReturnsWithinRangeInOrder)
{
  Scan scan;
  scan.T_vehicle_lidar.translation() = Eigen::Vector3d(1, 0, 2);
  const float inf = std::numeric_limits<float>::infinity();
  scan.points = {{0, 0, 0}, {5, 0, 0},   {0.5F, 0, 0}, test::nanPoint(),
                 {0, 7, 1}, {200, 0, 0}, {inf, 0, 0}};
  scan.intensity = {0, 0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F};
  ThreadPool pool(1);
  const Cloud cloud = Preprocessor(PreprocessOptions(), pool).prepare(scan, Pose::Identity(), 0.1);
  EXPECT_EQ(cloud.source, (std::vector<std::uint32_t>{1, 4}));
  EXPECT_EQ(cloud.intensity, (std::vector<float>{0.1F, 0.4F}));
  EXPECT_TRUE(cloud.points[0].isApprox(Eigen::Vector3f(6, 0, 2), 1e-5F));
  EXPECT_TRUE(cloud.points[1].isApprox(Eigen::Vector3f(1, 7, 3), 1e-5F));
}

/** Points around a lidar, with times over 0.1 s. */
Scan timedScan(const Pose& mounting, bool with_times)
{
  Scan scan;
  scan.T_vehicle_lidar = mounting;
  for (int i = 0; i < 100; ++i)
  {
    const double azimuth = -2 * M_PI * i / 100;
    scan.points.emplace_back(
        Eigen::Vector3d(0.2 * i * std::cos(azimuth), 0.2 * i * std::sin(azimuth), 1).cast<float>());
    if (with_times)
    {
      scan.time.push_back(0.001F * static_cast<float>(i) - 0.05F);
    }
  }
  return scan;
}

TEST(Preprocessor, ScansOfSeveralLidarsAreAsEachAlone)
{
  ThreadPool pool(2);
  const Pose motion = poseFromYpr(1, 0.1, 0, 0.05, 0, 0);
  const Pose T_vehicle_rear = poseFromYpr(-3, 0.2, 0.5, 2, 0, 0.1);
  for (const bool with_times : {true, false})
  {
    const Preprocessor preprocessor(PreprocessOptions(), pool);
    const Scan front = timedScan(poseFromYpr(1, 0, 1.7, 0, 0, 0), with_times);
    const Scan rear = timedScan(T_vehicle_rear, with_times);
    Scan both = front;
    appendScan(rear, 1, both);
    const Cloud a = preprocessor.prepare(front, motion, 0.1, 0.1);
    const Cloud b = preprocessor.prepare(rear, motion, 0.1, 0.1);
    const Cloud cloud = preprocessor.prepare(both, motion, 0.1, 0.1);
    ASSERT_EQ(cloud.size(), a.size() + b.size());
    EXPECT_LT(a.size(), front.size()) << "some are too near";
    ASSERT_EQ(cloud.phase.size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
    {
      const bool of_front = i < a.size();
      const std::size_t k = of_front ? i : i - a.size();
      EXPECT_TRUE(cloud.points[i].isApprox((of_front ? a : b).points[k], 1e-4F)) << i;
      EXPECT_EQ(cloud.source[i], of_front ? a.source[k] : front.size() + b.source[k]);
    }
    // A scan that is later by half the time of the motion has moved half as far more.
    Scan late = rear;
    late.stamp += 0.05;
    Scan with_late = front;
    appendScan(late, 1, with_late);
    const Cloud moved = preprocessor.prepare(with_late, motion, 0.1, 0.1);
    ASSERT_EQ(moved.size(), cloud.size());
    EXPECT_NEAR(moved.phase.back() - cloud.phase.back(), 0.5F, 1e-4F);
    const Eigen::Vector3d measured = T_vehicle_rear * rear.points.back().cast<double>();
    const Eigen::Vector3f expected =
        SweepMotion(motion, 0).toReference(measured.cast<float>(), moved.phase.back());
    EXPECT_LT((moved.points.back() - expected).norm(), 1e-3F);
    EXPECT_GT((moved.points.back() - cloud.points.back()).norm(), 0.2F);
  }
}

/** Without times of points the scans of several lidars are of different moments all the same. */
TEST(Preprocessor, ScansOfSeveralLidarsAreMovedByTheirStamps)
{
  ThreadPool pool(1);
  const Pose motion(Eigen::Translation3d(1, 0, 0));
  for (const DeskewMode deskew : {DeskewMode::none, DeskewMode::time, DeskewMode::automatic})
  {
    PreprocessOptions options;
    options.deskew = deskew;
    const Preprocessor preprocessor(options, pool);
    Scan front;
    front.points = {{5, 0, 0}};
    Scan rear = front;
    rear.stamp = 0.05;
    rear.T_vehicle_lidar = poseFromYpr(-3, 0, 0, M_PI, 0, 0);
    Scan both = front;
    appendScan(rear, 1, both);
    const Cloud cloud = preprocessor.prepare(both, motion, 0.1, 0.1);
    ASSERT_EQ(cloud.size(), 2U);
    ASSERT_EQ(cloud.phase.size(), 2U);
    EXPECT_NEAR(cloud.phase[1] - cloud.phase[0], 0.5F, 1e-4F);
    EXPECT_TRUE(cloud.T_sweep.isApprox(motion, 1e-9));
    if (deskew != DeskewMode::automatic)
    {
      EXPECT_NEAR(cloud.points[0].x(), 5, 1e-4F);
      EXPECT_NEAR(cloud.points[1].x(), -8 + 0.5, 1e-4F);
    }
    Cloud first = preprocessor.prepare(both, motion, 0);
    redeskew(motion, 0.1, pool, first);
    EXPECT_TRUE(first.points[1].isApprox(cloud.points[1], 1e-4F)) << "once its motion is known";
  }
}

/** A further lidar without returns does not decide about the others. */
TEST(Preprocessor, APartWithoutPointsChangesNothing)
{
  ThreadPool pool(1);
  const Pose motion = poseFromYpr(1, 0.1, 0, 0.05, 0, 0);
  for (const DeskewMode deskew : {DeskewMode::time, DeskewMode::automatic})
  {
    PreprocessOptions options;
    options.deskew = deskew;
    const Preprocessor preprocessor(options, pool);
    const Scan alone = timedScan(Pose::Identity(), true);
    Scan both = alone;
    appendScan(Scan(), 1, both);
    for (const double dt : {0.1, 0.0})
    {
      const Cloud a = preprocessor.prepare(alone, motion, dt, dt);
      const Cloud b = preprocessor.prepare(both, motion, dt, dt);
      EXPECT_EQ(a.points, b.points);
      EXPECT_EQ(a.phase, b.phase);
      EXPECT_EQ(a.phase_unit, b.phase_unit);
      EXPECT_TRUE(a.T_sweep.isApprox(b.T_sweep, 1e-12));
    }
  }
}

TEST(Preprocessor, EmptyScanGivesEmptyCloud)
{
  ThreadPool pool(1);
  EXPECT_EQ(Preprocessor(PreprocessOptions(), pool).prepare(Scan(), Pose::Identity(), 0.1).size(),
            0U);
}

TEST(Preprocessor, DeskewsByTimeAndByAzimuth)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1.0, 0.05, 0, 3 * test::degree, 0, 0);
  Scan skewed = scene.scan(Pose::Identity(), 0, 1, motion);
  const Eigen::Vector3d sensor = skewed.T_vehicle_lidar.translation();
  ThreadPool pool(2);
  PreprocessOptions options;
  const double before =
      skewLeft(Preprocessor(options, pool).prepare(skewed, Pose::Identity(), 0.1), scene, sensor);
  EXPECT_GT(before, 0.1);
  // By time about the stamp, which is mid-sweep here; half the motion over half the time.
  const Cloud by_time = Preprocessor(options, pool).prepare(skewed, motion, 0.1);
  EXPECT_LT(skewLeft(by_time, scene, sensor), 0.25 * before);
  EXPECT_EQ(by_time.phase.size(), by_time.size());
  skewed.time.clear();
  const Cloud by_azimuth = Preprocessor(options, pool).prepare(skewed, motion, 0.1);
  ASSERT_EQ(by_azimuth.size(), by_time.size());
  for (std::size_t i = 0; i < by_time.size(); ++i)
  {
    EXPECT_LT((by_time.points[i] - by_azimuth.points[i]).norm(), 2e-3F);
  }
  options.sweep.direction = 1;
  EXPECT_GT(skewLeft(Preprocessor(options, pool).prepare(skewed, motion, 0.1), scene, sensor),
            before);
}

TEST(Preprocessor, DeskewsByTheOrderOfPointsAsFired)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1.0, 0.05, 0, 3 * test::degree, 0, 0);
  const Scan timed = scene.scan(Pose::Identity(), 0, 1, motion);
  std::vector<std::size_t> order(timed.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return timed.time[a] < timed.time[b]; });
  Scan fired = timed;
  fired.time.clear();
  Scan expected = timed;
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    fired.points[i] = timed.points[order[i]];
    expected.points[i] = timed.points[order[i]];
    expected.time[i] = timed.time[order[i]];
  }
  ThreadPool pool(2);
  PreprocessOptions options;
  options.sweep.start_azimuth = 0;  // another one than the order shows
  for (const DeskewMode mode : {DeskewMode::time, DeskewMode::automatic})
  {
    options.deskew = mode;
    const Preprocessor preprocessor(options, pool);
    const Cloud by_order = preprocessor.prepare(fired, motion, 0.1);
    const Cloud by_time = preprocessor.prepare(expected, motion, 0.1);
    ASSERT_EQ(by_order.phase.size(), by_order.size());
    ASSERT_EQ(by_order.size(), by_time.size());
    for (std::size_t i = 0; i < by_time.size(); ++i)
    {
      EXPECT_NEAR(by_time.phase[i], by_order.phase[i], 0.01F);
      EXPECT_LT((by_time.points[i] - by_order.points[i]).norm(), 0.03F);
    }
  }
  options.deskew = DeskewMode::time;
  std::shuffle(fired.points.begin(), fired.points.end(), std::mt19937(1));
  EXPECT_TRUE(Preprocessor(options, pool).prepare(fired, motion, 0.1).phase.empty());
}

TEST(Preprocessor, EqualTimesAreThoseOfADeskewedScanAlsoOfTheFirst)
{
  const test::StreetScene scene;
  Scan scan = scene.scan(Pose::Identity(), 0, 1, poseFromYpr(1.0, 0, 0, 0, 0, 0));
  std::fill(scan.time.begin(), scan.time.end(), 0.0F);
  ThreadPool pool(1);
  const Cloud first =
      Preprocessor(PreprocessOptions(), pool).prepare(scan, Pose::Identity(), 0, 0.1);
  EXPECT_TRUE(std::all_of(first.phase.begin(), first.phase.end(), [](float p) { return p == 0; }));
}

TEST(Preprocessor, NoDeskewWithoutPeriodOrIfOff)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1, 0, 0, 0, 0, 0);
  const Scan scan = scene.scan(Pose::Identity(), 0, 1, motion);
  ThreadPool pool(1);
  PreprocessOptions off;
  off.deskew = DeskewMode::none;
  const Cloud a = Preprocessor(off, pool).prepare(scan, motion, 0.1);
  const Cloud b = Preprocessor(PreprocessOptions(), pool).prepare(scan, motion, 0);
  EXPECT_EQ(a.points, b.points);
  EXPECT_TRUE(a.phase.empty());
  EXPECT_TRUE(b.T_sweep.isApprox(Pose::Identity()));
}

/** The phases of a first scan, whose motion is known with the second one. */
TEST(Preprocessor, PhasesWithoutAPeriodAreInUnitsOfTheScansDuration)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1, 0, 0, 0, 0, 0);
  const Scan scan = scene.scan(Pose::Identity(), 0, 1, motion);
  ThreadPool pool(1);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  const Cloud first = preprocessor.prepare(scan, motion, 0);
  const Cloud known = preprocessor.prepare(scan, motion, 0.1);
  ASSERT_EQ(first.phase.size(), known.phase.size());
  EXPECT_NEAR(first.phase_unit, 0.1, 2e-4);
  EXPECT_EQ(known.phase_unit, 0.1);
  const auto scale = static_cast<float>(first.phase_unit / known.phase_unit);
  for (std::size_t i = 0; i < first.phase.size(); i += 100)
  {
    EXPECT_NEAR(first.phase[i] * scale, known.phase[i], 1e-5F);
  }
  Scan untimed = scan;
  untimed.time.clear();
  EXPECT_EQ(preprocessor.prepare(untimed, motion, 0).phase_unit, 0) << "one revolution";
}

float largestDifference(const Cloud& a, const Cloud& b)
{
  EXPECT_EQ(a.source, b.source);
  float largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
  {
    largest = std::max(largest, (a.points[i] - b.points[i]).norm());
  }
  return largest;
}

/** By azimuth, a sweep lasts as long as the sensor turns once, however many scans are missing. */
TEST(Preprocessor, MissingScansDoNotMakeTheSweepLonger)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1, 0, 0, 3 * test::degree, 0, 0);
  Scan scan = scene.scan(Pose::Identity(), 0, 1, motion);
  scan.time.clear();
  ThreadPool pool(1);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  const Cloud expected = preprocessor.prepare(scan, motion, 0.1, 0.1);
  const Cloud after_gap = preprocessor.prepare(scan, motion * motion * motion, 0.3, 0.1);
  EXPECT_LT(largestDifference(expected, after_gap), 1e-3F);
  EXPECT_EQ(after_gap.phase_unit, 0.3);
  EXPECT_GT(largestDifference(expected, preprocessor.prepare(scan, motion * motion, 0.2)), 0.1F)
      << "without a duration, the sweep lasts as long as the interval";
}

TEST(Preprocessor, RedeskewsByAnotherMotion)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1, 0.1, 0, 3 * test::degree, 0, 0);
  Scan scan = scene.scan(Pose::Identity(), 0, 1, motion);
  ThreadPool pool(2);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  for (const bool timed : {true, false})
  {
    const Cloud expected = preprocessor.prepare(scan, motion, 0.1, 0.1);
    const Pose wrong = motion * poseFromYpr(0.2, 0, 0, 1 * test::degree, 0, 0);
    Cloud cloud = preprocessor.prepare(scan, wrong, 0.1, 0.1);
    EXPECT_GT(largestDifference(expected, cloud), 0.1F);
    redeskew(motion, 0.1, pool, cloud);
    EXPECT_LT(largestDifference(expected, cloud), 2e-4F) << timed;
    EXPECT_TRUE(cloud.T_sweep.isApprox(motion));
    // A first scan, whose motion the second one has shown.
    Cloud first = preprocessor.prepare(scan, motion, 0);
    EXPECT_GT(largestDifference(expected, first), 0.1F);
    redeskew(motion, 0.1, pool, first);
    EXPECT_LT(largestDifference(expected, first), 2e-4F) << timed;
    EXPECT_EQ(first.phase_unit, 0.1);
    scan.time.clear();
  }
}

TEST(Preprocessor, RedeskewLeavesWhatHasNoPhasesOrTheSameMotion)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1, 0, 0, 0, 0, 0);
  const Scan scan = scene.scan(Pose::Identity(), 0, 1, motion);
  ThreadPool pool(1);
  PreprocessOptions off;
  off.deskew = DeskewMode::none;
  Cloud cloud = Preprocessor(off, pool).prepare(scan, motion, 0.1);
  const Cloud without_phases = cloud;
  redeskew(motion, 0.1, pool, cloud);
  EXPECT_EQ(cloud.points, without_phases.points);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  cloud = preprocessor.prepare(scan, motion, 0.1);
  const Cloud before = cloud;
  redeskew(motion * poseFromYpr(5e-4, 0, 0, 0, 0, 0), 0.1, pool, cloud);
  EXPECT_EQ(cloud.points, before.points);
  redeskew(Pose::Identity(), 0, pool, cloud);  // no time has passed
  EXPECT_EQ(cloud.points, before.points);
}

/** As of a damaged field: neither are the points used nor does the rest of the scan suffer. */
TEST(Preprocessor, PointsWithImpossibleTimesAreLeftOut)
{
  const Pose motion = poseFromYpr(1, 0.1, 0, 3 * test::degree, 0, 0);
  ThreadPool pool(1);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  Scan scan;
  scan.points = {{5, 1, 0}, {5, 2, 0}, {5, 3, 0}};
  const Eigen::Vector3f expected = SweepMotion(motion, 0).toReference(scan.points.back(), 0.5F);
  for (const float wrong : {-100.0F, 1e6F, -1e19F, 1e30F, -3e38F, INFINITY, NAN})
  {
    scan.time = {wrong, 0, 0.05F};
    for (const double dt : {0.0, 0.1})
    {
      Cloud cloud = preprocessor.prepare(scan, motion * motion, dt, dt);
      redeskew(motion, 0.1, pool, cloud);
      ASSERT_EQ(cloud.source, (std::vector<std::uint32_t>{1, 2})) << wrong << " " << dt;
      EXPECT_LT((cloud.points[0] - scan.points[1]).norm(), 1e-5F) << wrong << " " << dt;
      EXPECT_LT((cloud.points[1] - expected).norm(), 1e-4F) << wrong << " " << dt;
    }
    EXPECT_FLOAT_EQ(static_cast<float>(preprocessor.sweepSpan(scan, 0.1).second), 0.05F) << wrong;
    scan.time.assign(scan.size(), wrong);
    EXPECT_EQ(preprocessor.prepare(scan, motion, 0.1, 0.1).size(), scan.size()) << "by azimuth";
  }
}

TEST(Preprocessor, SameForAnyNumberOfThreads)
{
  const test::StreetScene scene;
  const Pose motion = poseFromYpr(1, 0, 0, 0.02, 0, 0);
  const Scan scan = scene.scan(Pose::Identity(), 0.01, 1, motion);
  ThreadPool one(1);
  ThreadPool three(3);
  const Cloud a = Preprocessor(PreprocessOptions(), one).prepare(scan, motion, 0.1);
  const Cloud b = Preprocessor(PreprocessOptions(), three).prepare(scan, motion, 0.1);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.source, b.source);
}

TEST(Preprocessor, RefusesBadOptions)
{
  ThreadPool pool(1);
  PreprocessOptions options;
  options.max_range = -1;
  EXPECT_THROW(Preprocessor(options, pool), UserError);
  // A sensor that does not turn would leave every scan as it is.
  PreprocessOptions still;
  still.sweep.direction = 0;
  EXPECT_THROW(Preprocessor(still, pool), UserError);
  EXPECT_THROW(
      load(still, Config::fromText("[preprocess]\nsweep_direction = 0\n", "x.ini"), "preprocess"),
      UserError);
  load(still, Config::fromText("[preprocess]\nsweep_direction = 1\n", "x.ini"), "preprocess");
  EXPECT_EQ(still.sweep.direction, 1);
}
}  // namespace
}  // namespace dyslam
