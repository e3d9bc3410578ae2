// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/ScanPattern.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace dyslam
{
namespace
{
constexpr double degree = M_PI / 180;

Eigen::Vector3f direction(double azimuth, double elevation)
{
  return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                         std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
      .cast<float>();
}

/** Spinning sensor within a ball of 20 m. */
Scan spinning(int rings, double lowest, double step, int columns, double noise)
{
  std::mt19937 random(3);
  std::normal_distribution<float> error(0, static_cast<float>(noise));
  Scan scan;
  for (int c = 0; c < columns; ++c)
  {
    for (int r = 0; r < rings; ++r)
    {
      scan.points.push_back((20 + error(random)) *
                            direction(360 * degree * c / columns, lowest + step * r));
      scan.ring.push_back(static_cast<std::uint16_t>(r));
      scan.time.push_back(0.1F * static_cast<float>(c) / static_cast<float>(columns));
    }
  }
  return scan;
}

/** Directions without order in a field of view ahead. */
Scan scattered(std::size_t count)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> azimuth(-35 * degree, 35 * degree);
  std::uniform_real_distribution<double> elevation(-7 * degree, 52 * degree);
  Scan scan;
  for (std::size_t i = 0; i < count; ++i)
  {
    scan.points.push_back(12 * direction(azimuth(random), elevation(random)));
  }
  return scan;
}
}  // namespace

TEST(ScanPattern, SpinningSensorIsMeasured)
{
  const ScanPattern p = measureScanPattern(spinning(16, -15 * degree, 2 * degree, 900, 0.02));
  EXPECT_EQ(p.rings.size(), 16U);
  EXPECT_TRUE(p.ring_numbers);
  EXPECT_TRUE(p.point_times);
  EXPECT_NEAR(p.duration, 0.1, 0.001);
  EXPECT_NEAR(p.lowest, -15 * degree, 1e-4);
  EXPECT_NEAR(p.highest, 15 * degree, 1e-4);
  EXPECT_NEAR(p.ring_spacing, 2 * degree, 1e-4);
  EXPECT_NEAR(p.column_spacing, 0.4 * degree, 1e-4);
  EXPECT_NEAR(p.azimuth_extent, 360 * degree, 1e-9);
  EXPECT_NEAR(p.range_noise, 0.02, 0.002);
  EXPECT_NEAR(p.spacing(), 2 * degree, 1e-4);
}

TEST(ScanPattern, RingsAreFoundWithoutNumbers)
{
  Scan scan = spinning(32, -30 * degree, 1.333 * degree, 1000, 0.01);
  scan.ring.clear();
  scan.points[5].setConstant(std::numeric_limits<float>::quiet_NaN());
  const ScanPattern p = measureScanPattern(scan);
  EXPECT_EQ(p.rings.size(), 32U);
  EXPECT_FALSE(p.ring_numbers);
  EXPECT_NEAR(p.ring_spacing, 1.333 * degree, 1e-3);
}

TEST(ScanPattern, EmptyRingsAreCounted)
{
  const Scan all = spinning(32, -30 * degree, 1 * degree, 400, 0);
  Scan scan;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    if (all.ring[i] % 3 == 0)
    {
      scan.points.push_back(all.points[i]);
      scan.ring.push_back(all.ring[i]);
    }
  }
  EXPECT_NEAR(measureScanPattern(scan).ring_spacing, 1 * degree, 1e-4);
}

/** The even lasers of an HDL-32E are below the odd ones. */
TEST(ScanPattern, LasersMayBeNumberedAsTheyFire)
{
  Scan scan = spinning(32, -30.67 * degree, 1.333 * degree, 400, 0);
  for (std::uint16_t& ring : scan.ring)
  {
    ring = static_cast<std::uint16_t>(ring < 16 ? 2 * ring : 2 * (ring - 16) + 1);
  }
  EXPECT_NEAR(measureScanPattern(scan).ring_spacing, 1.333 * degree, 1e-4);
}

TEST(ScanPattern, OfSeveralLidarsThatOfTheFirst)
{
  const Scan first = spinning(16, -15 * degree, 2 * degree, 900, 0.02);
  Scan second = spinning(32, -30 * degree, 1.333 * degree, 400, 0);
  second.T_vehicle_lidar = poseFromYpr(-1, 0, -0.5, M_PI, -0.15, 0);
  Scan both = first;
  appendScan(second, 1, both);
  const ScanPattern alone = measureScanPattern(first);
  const ScanPattern p = measureScanPattern(both);
  EXPECT_EQ(p.rings, alone.rings);
  EXPECT_EQ(p.returns, alone.returns);
  EXPECT_EQ(p.spacing(), alone.spacing());
  EXPECT_NEAR(p.ring_spacing, 2 * degree, 1e-4);
}

/** A lidar that is upside down a metre from the origin of its points, as in NCLT. */
TEST(ScanPattern, RecordedRingsOfPointsThatWereMoved)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<float> range(6, 40);
  const auto moved = [&](int columns)
  {
    Scan scan = spinning(32, -10.67 * degree, 1.333 * degree, 400, 0);
    scan.points.resize(static_cast<std::size_t>(32 * columns));
    scan.ring.resize(scan.size());
    scan.time.clear();
    for (Eigen::Vector3f& p : scan.points)
    {
      p = range(random) * p.normalized() + Eigen::Vector3f(0.3F, 0, 1);
    }
    return scan;
  };
  const Scan turning = moved(400);
  const ScanPattern p = measureScanPattern(turning);
  EXPECT_EQ(p.rings.size(), 32U);
  EXPECT_TRUE(p.ring_numbers);
  EXPECT_NEAR(p.ring_spacing, 1.333 * degree, 0.2 * degree);
  EXPECT_EQ(ringsOf(turning.points, turning.ring), turning.ring);
  EXPECT_FALSE(measureScanPattern(moved(150)).hasRings()) << "rows of a camera";
  Scan shuffled = turning;
  std::shuffle(shuffled.ring.begin(), shuffled.ring.end(), random);
  EXPECT_FALSE(measureScanPattern(shuffled).hasRings()) << "lines without an elevation";
}

TEST(ScanPattern, ScatteredPointsHaveNoRings)
{
  Scan scan = scattered(20000);
  const ScanPattern p = measureScanPattern(scan);
  EXPECT_FALSE(p.hasRings());
  EXPECT_NEAR(p.azimuth_extent, 70 * degree, 2 * degree);
  EXPECT_NEAR(p.lowest, -7 * degree, 0.2 * degree);
  EXPECT_NEAR(p.highest, 52 * degree, 0.2 * degree);
  const double solid = 70 * degree * (std::sin(52 * degree) + std::sin(7 * degree));
  EXPECT_NEAR(p.spacing(), std::sqrt(solid / 20000), 0.0003);
  // Lines, not rings.
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    scan.ring.push_back(static_cast<std::uint16_t>(i % 6));
  }
  EXPECT_FALSE(measureScanPattern(scan).hasRings());
}

/** The times of points that returned nothing may be NaN, those of the first points, too. */
TEST(ScanPattern, DamagedPointsAndUnknownTimesDoNotCount)
{
  Scan scan = spinning(16, -15 * degree, 2 * degree, 900, 0.02);
  const ScanPattern sound = measureScanPattern(scan);
  for (const float damaged : {NAN, INFINITY, -1e6F, 3e38F})
  {
    scan.time.front() = damaged;
    scan.points.front() = {damaged, 1e30F, 1e30F};
    const ScanPattern p = measureScanPattern(scan);
    EXPECT_TRUE(p.point_times) << damaged;
    EXPECT_NEAR(p.duration, sound.duration, 1e-3) << damaged;
    EXPECT_NEAR(p.max_range, sound.max_range, 0.1) << damaged;
  }
}

TEST(ScanPattern, EmptyAndSinglePoint)
{
  EXPECT_EQ(measureScanPattern(Scan()).returns, 0U);
  EXPECT_EQ(measureScanPattern(Scan()).spacing(), 0);
  Scan one;
  one.points.emplace_back(3, 0, 0);
  const ScanPattern p = measureScanPattern(one);
  EXPECT_EQ(p.returns, 1U);
  EXPECT_NEAR(p.max_range, 3, 1e-6);
  EXPECT_FALSE(p.hasRings());
}
}  // namespace dyslam
