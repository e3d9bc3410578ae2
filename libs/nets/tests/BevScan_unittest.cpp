// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/nets/BevScan.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace
{
using dyslam::BevOptions;
using dyslam::BevRays;
using dyslam::BevScan;
using dyslam::makeBevScan;

std::vector<Eigen::Vector3f> tiltedGround(unsigned seed, float slope)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-60, 60);
  std::normal_distribution<float> noise(0, 0.02F);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 60000; ++i)
  {
    const float x = place(random);
    const float y = place(random);
    points.emplace_back(x, y, -1.7F + slope * x + noise(random));
  }
  return points;
}

TEST(BevGround, FollowsASlope)
{
  const dyslam::BevGround ground(tiltedGround(1, 0.03F));
  for (const float x : {-40.0F, -10.0F, 0.0F, 25.0F, 45.0F})
  {
    EXPECT_NEAR(ground.heightAt(x, 5), -1.7 + 0.03 * x, 0.12) << "at " << x;
  }
}

TEST(BevGround, IgnoresRoofsAndMultipathEchoes)
{
  auto points = tiltedGround(2, 0);
  // A truck's roof occludes the ground under it; multipath echoes lie far below the ground.
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const Eigen::Vector3f& p)
                              { return p.x() > 9 && p.x() < 20 && std::abs(p.y()) < 3.5F; }),
               points.end());
  for (int i = 0; i < 400; ++i)
  {
    points.emplace_back(9.5F + 0.025F * static_cast<float>(i), 0.5F, 1.8F);
    points.emplace_back(-15.0F + 0.001F * static_cast<float>(i), -10.0F, -4.5F);
  }
  const dyslam::BevGround ground(points);
  EXPECT_NEAR(ground.heightAt(14, 0), -1.7, 0.3);
  EXPECT_NEAR(ground.heightAt(-15, -10), -1.7, 0.3);
}

TEST(BevGround, SeedIgnoresOwnRoofAndTallNeighbours)
{
  auto points = tiltedGround(4, 0);
  // The vehicle's own roof, and a truck beside it that occludes the ground.
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const Eigen::Vector3f& p) {
                                return p.head<2>().norm() < 5 ||
                                       (std::abs(p.x()) < 8 && p.y() > 3 && p.y() < 8);
                              }),
               points.end());
  for (int i = 0; i < 400; ++i)
  {
    const float along = 0.005F * static_cast<float>(i);
    points.emplace_back(along - 1, along - 1, -0.15F);
    points.emplace_back(8 * along - 8, 3.4F, 0.5F + along);
  }
  const dyslam::BevGround ground(points);
  for (const float x : {-30.0F, -6.0F, 0.0F, 6.0F, 30.0F})
  {
    EXPECT_NEAR(ground.heightAt(x, -4), -1.7, 0.15) << "at " << x;
    EXPECT_NEAR(ground.heightAt(x, 5), -1.7, 0.3) << "at " << x;
  }
}

TEST(BevGround, IsZeroWithoutPoints)
{
  EXPECT_EQ(dyslam::BevGround({}).heightAt(3, 3), 0);
}

TEST(BevScan, KeepsPointsAboveGroundInTheirCells)
{
  auto points = tiltedGround(3, 0);
  const auto ground_points = points.size();
  points.emplace_back(10.05F, -3.33F, -0.7F);
  points.emplace_back(10.11F, -3.27F, -0.2F);
  points.emplace_back(10.0F, 4.0F, 9.0F);   // too high
  points.emplace_back(100.0F, 4.0F, 0.0F);  // outside
  points.emplace_back(12.0F, 4.0F, -3.0F);  // below ground
  points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  const BevOptions options;
  const auto scan = makeBevScan(points, options);
  ASSERT_EQ(scan.size(), 2U);
  EXPECT_EQ(scan.source[0] + scan.source[1], 2 * ground_points + 1);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const auto& p = scan.points[i];
    const int ix = static_cast<int>(std::floor((p.x() + 51.2F) / 0.2F));
    const int iy = static_cast<int>(std::floor((p.y() + 51.2F) / 0.2F));
    EXPECT_EQ(scan.cell[i], iy * 512 + ix);
    EXPECT_NEAR(scan.height[i], p.z() + 1.7F, 0.1);
  }
  // Both points lie in one cell and share its highest and lowest point.
  EXPECT_EQ(scan.cell[0], scan.cell[1]);
  EXPECT_FLOAT_EQ(scan.features[6], std::max(scan.height[0], scan.height[1]) - 1);
  EXPECT_FLOAT_EQ(scan.features[7], std::min(scan.height[0], scan.height[1]) - 1);
}

TEST(BevScan, CellsAreSortedAndTheGridFollowsItsCentre)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-70, 70);
  std::uniform_real_distribution<float> height(-1, 2);
  auto points = tiltedGround(4, 0);
  for (int i = 0; i < 3000; ++i)
  {
    points.emplace_back(place(random), place(random), height(random));
  }
  BevOptions options;
  options.cells = 128;
  const auto scan = makeBevScan(points, options, {20, -10});
  ASSERT_GT(scan.size(), 20U);
  EXPECT_TRUE(std::is_sorted(scan.cell.begin(), scan.cell.end()));
  EXPECT_FLOAT_EQ(scan.corner.x(), 20 - 12.8F);
  EXPECT_EQ(scan.features.size(), scan.size() * BevScan::feature_count);
  for (const auto& p : scan.points)
  {
    EXPECT_LT(std::abs(p.x() - 20), 12.81F);
    EXPECT_LT(std::abs(p.y() + 10), 12.81F);
  }
}

TEST(BevScan, RejectsSidesThatAreNoMultipleOf16)
{
  BevOptions options;
  options.cells = 100;
  EXPECT_THROW((void)makeBevScan({{1, 1, 1}}, options), dyslam::UserError);
  const auto config = dyslam::Config::fromText("[grid]\ncells = 100\n", "test");
  EXPECT_THROW(dyslam::load(options, config, "grid"), dyslam::UserError);
}

TEST(BevScan, HandlesEmptyAndOnePoint)
{
  EXPECT_EQ(makeBevScan({}, BevOptions()).size(), 0U);
  EXPECT_LE(makeBevScan({{1, 1, 1}}, BevOptions()).size(), 1U);
}

TEST(BevRays, DistinguishesFreeOccupiedAndUnobserved)
{
  std::vector<Eigen::Vector3f> wall;
  for (float y = -5; y < 5; y += 0.02F)
  {
    for (float z = -1; z < 1; z += 0.05F)
    {
      wall.emplace_back(20.0F, y, z);
    }
  }
  const BevRays rays(wall);
  float out[BevRays::channels];
  rays.compare({18.5F, 0.3F, 0.0F}, out);  // before the wall: observed free
  EXPECT_NEAR(out[0], 0.75, 0.05);
  EXPECT_FLOAT_EQ(out[1], 1);
  rays.compare({20.0F, 0.3F, 0.0F}, out);  // on the wall: occupied
  EXPECT_NEAR(out[0], 0, 0.03);
  EXPECT_NEAR(out[1], 0, 0.03);
  rays.compare({24.0F, 0.3F, 0.0F}, out);  // occluded by the wall
  EXPECT_FLOAT_EQ(out[0], -1);
  rays.compare({-20.0F, 0.3F, 0.0F}, out);  // not observed
  EXPECT_FLOAT_EQ(out[2], 0);
}

TEST(BevRays, DirectionsAboveAndBelowTheImageAreUnobserved)
{
  const std::vector<Eigen::Vector3f> steep = {
      {0, 0, 1e30F}, {0, 0, -1e30F}, {1, 0, 5}, {1, 0, -5}, {1, NAN, 0}};
  const BevRays rays(steep);
  for (const Eigen::Vector3f& p : steep)
  {
    float out[BevRays::channels];
    rays.compare(p, out);
    EXPECT_FLOAT_EQ(out[2], 0) << p.transpose();
  }
}
}  // namespace
