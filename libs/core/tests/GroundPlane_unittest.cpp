// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/Pose.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

/** A road between two walls, 10 m apart, with parked cars, as seen from 1.7 m above it. */
Points street()
{
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.02F);
  Points points;
  for (float x = -20; x < 20; x += 0.25F)
  {
    for (float y = -5; y < 5; y += 0.25F)
    {
      points.emplace_back(x, y, -1.7F + noise(random));
    }
    for (float z = -1.7F; z < 4; z += 0.25F)
    {
      points.emplace_back(x, 5 + noise(random), z);
      points.emplace_back(x, -5 + noise(random), z);
    }
    if (std::fmod(std::abs(x), 6.0F) < 4)
    {
      for (float z = -1.7F; z < -0.3F; z += 0.25F)
      {
        points.emplace_back(x, 3.5F + noise(random), z);
      }
    }
  }
  return points;
}

/** The same in the frame of a sensor that is tilted. */
Points seenTilted(const Points& points, double roll_deg, double pitch_deg)
{
  const Eigen::Matrix3f R_sensor_level =
      poseFromYpr(0, 0, 0, 0, pitch_deg * radians_per_degree, roll_deg * radians_per_degree)
          .linear()
          .transpose()
          .cast<float>();
  Points seen;
  for (const Eigen::Vector3f& p : points)
  {
    seen.emplace_back(R_sensor_level * p);
  }
  return seen;
}

TEST(GroundPlane, IsFoundInAStreet)
{
  const auto ground = findGroundPlane(street());
  ASSERT_TRUE(ground);
  EXPECT_LT(ground->inclination(), 0.3 * radians_per_degree);
  EXPECT_NEAR(1.7, ground->height, 0.02);
  EXPECT_GT(ground->share, 0.3);
}

TEST(GroundPlane, RollAndPitchAreThoseOfTheSensor)
{
  constexpr double tolerance = 0.3 * radians_per_degree;
  for (const auto& [roll, pitch] :
       {std::pair(0, 20), std::pair(0, -35), std::pair(15, 0), std::pair(-25, 10)})
  {
    const auto ground = findGroundPlane(seenTilted(street(), roll, pitch));
    ASSERT_TRUE(ground) << roll << " " << pitch;
    EXPECT_NEAR(roll * radians_per_degree, ground->roll(), tolerance);
    EXPECT_NEAR(pitch * radians_per_degree, ground->pitch(), tolerance);
    EXPECT_NEAR(1.7, ground->height, 0.03);
    const Eigen::Vector3d up =
        poseFromYpr(0, 0, 0, 0, ground->pitch(), ground->roll()).linear() * ground->normal;
    EXPECT_LT((up - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  }
}

TEST(GroundPlane, IsAboveASensorThatHangsUpsideDown)
{
  Points outdoors;
  for (const Eigen::Vector3f& p : street())
  {
    if (std::abs(p.y()) < 4.9F || p.z() < 1)
    {
      outdoors.push_back(p);
    }
  }
  const Points seen = seenTilted(outdoors, 180, 5);
  EXPECT_FALSE(findGroundPlane(seen));
  const auto ground = findGroundPlane(seen, GroundSide::above);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(M_PI, std::abs(ground->roll()), 0.5 * radians_per_degree);
  EXPECT_NEAR(5 * radians_per_degree, ground->pitch(), 0.5 * radians_per_degree);
}

TEST(GroundPlane, MayPassThroughTheOrigin)
{
  Points points = street();  // some drivers give points in a frame on the ground
  for (Eigen::Vector3f& p : points)
  {
    p.z() += 1.7F;
  }
  const auto ground = findGroundPlane(points);
  ASSERT_TRUE(ground);
  EXPECT_LT(ground->inclination(), 0.3 * radians_per_degree);
  EXPECT_NEAR(0, ground->height, 0.02);
  EXPECT_GT(ground->normal.z(), 0);
}

TEST(GroundPlane, MayBeAnEmbankment)
{
  Points points;  // a road whose sides fall off, and little else
  for (float x = -15; x < 15; x += 0.25F)
  {
    for (float y = -4; y < 4; y += 0.25F)
    {
      points.emplace_back(x, y, -1.7F);
    }
    for (float y = 4; y < 6; y += 0.25F)
    {
      points.emplace_back(x, y, -1.7F - 0.5F * (y - 4));
      points.emplace_back(x, -y, -1.7F - 0.5F * (y - 4));
    }
  }
  const auto ground = findGroundPlane(points);
  ASSERT_TRUE(ground);
  EXPECT_LT(ground->inclination(), 0.5 * radians_per_degree);
  EXPECT_NEAR(1.7, ground->height, 0.05);
}

TEST(GroundPlane, IsNotAWallNorACeilingNorThinAir)
{
  Points walls;
  for (const Eigen::Vector3f& p : street())
  {
    if (std::abs(p.y()) > 4.5F)
    {
      walls.push_back(p);
    }
  }
  EXPECT_FALSE(findGroundPlane(walls));
  EXPECT_FALSE(findGroundPlane({}));
  Points ceiling;
  for (const Eigen::Vector3f& p : street())
  {
    if (p.z() > -1)
    {
      ceiling.push_back(p);
    }
    else if (p.z() < -1.6F)
    {
      ceiling.emplace_back(p.x(), p.y(), 2.5F);
    }
  }
  EXPECT_FALSE(findGroundPlane(ceiling));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(findGroundPlane(Points(1000, Eigen::Vector3f(nan, nan, nan))));
  std::mt19937 random(1);
  std::uniform_real_distribution<float> anywhere(-10, 10);
  Points cloud;
  for (int i = 0; i < 3000; ++i)
  {
    cloud.emplace_back(anywhere(random), anywhere(random), anywhere(random));
  }
  EXPECT_FALSE(findGroundPlane(cloud));
}

TEST(GroundPlane, IsTheSameForTheSamePoints)
{
  const auto once = findGroundPlane(seenTilted(street(), 3, 8));
  const auto again = findGroundPlane(seenTilted(street(), 3, 8));
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->normal, again->normal);
  EXPECT_EQ(once->height, again->height);
}
}  // namespace
}  // namespace dyslam
