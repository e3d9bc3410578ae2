// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/OwnVehicle.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>

using namespace dyslam;

namespace
{
const Eigen::Vector3f mast{-0.4F, 0.55F, 0.1F};
const Eigen::Vector3f at_a_post{0.8F, -0.9F, 0.2F};  // in one scan, the lidar is beside it

/** Scan `number` of a lidar that moves along x by `step` [m] from scan to scan: the vehicle's mast,
 * and posts at every metre of the way. */
Scan scanFrom(int number, double step)
{
  Scan scan;
  scan.points = {mast, Eigen::Vector3f(8, 2, 1)};
  for (int post = -3; post < 20; ++post)
  {
    scan.points.emplace_back(static_cast<float>(post - number * step), -0.9F, 0.2F);
  }
  return scan;
}

/** After this many scans. */
OwnVehicle observed(int scans, double step, double range = 1.5)
{
  OwnVehicle vehicle(range);
  for (int i = 0; i < scans; ++i)
  {
    vehicle.observe(scanFrom(i, step));
    vehicle.addMotion(Pose(Eigen::Translation3d(step, 0, 0)));
  }
  return vehicle;
}

TEST(OwnVehicle, WhatPassesIsNotTheVehicle)
{
  const OwnVehicle vehicle = observed(30, 0.37);
  EXPECT_TRUE(vehicle.mayBeAt(mast));
  EXPECT_TRUE(vehicle.mayBeAt(mast + Eigen::Vector3f(0.1F, -0.1F, 0.1F))) << "beside it";
  EXPECT_FALSE(vehicle.mayBeAt(at_a_post));
  EXPECT_FALSE(vehicle.mayBeAt({0.5F, 0.5F, 0}));
  EXPECT_FALSE(vehicle.mayBeAt({8, 2, 1})) << "too far for the vehicle";
}

/** As a robot that drives behind another one from some time on. */
TEST(OwnVehicle, WhoJoinsLaterAtAConstantDistanceIsNotTheVehicle)
{
  const Eigen::Vector3f other{1, 0, 0};
  const Eigen::Vector3f beside_the_mast = mast + Eigen::Vector3f(0.1F, 0, 0);  // a lid that opens
  OwnVehicle vehicle = observed(30, 0.37);
  for (int i = 30; i < 60; ++i)
  {
    Scan scan = scanFrom(i, 0.37);
    scan.points.push_back(other);
    scan.points.push_back(beside_the_mast);
    vehicle.observe(scan);
    vehicle.addMotion(Pose(Eigen::Translation3d(0.37, 0, 0)));
  }
  EXPECT_FALSE(vehicle.mayBeAt(other));
  EXPECT_TRUE(vehicle.mayBeAt(beside_the_mast + Eigen::Vector3f(0.1F, 0, 0)));
  EXPECT_TRUE(vehicle.mayBeAt(mast));
}

/** Until then it may be either. */
TEST(OwnVehicle, WhoIsThereFromTheBeginningIsForgottenOnceGone)
{
  const Eigen::Vector3f other{1, 0, 0};
  OwnVehicle vehicle(1.5);
  const auto drive = [&](int begin, int end, bool with_other)
  {
    for (int i = begin; i < end; ++i)
    {
      Scan scan = scanFrom(i, 0.37);
      if (with_other)
      {
        scan.points.push_back(other);
      }
      vehicle.observe(scan);
      vehicle.addMotion(Pose(Eigen::Translation3d(0.37, 0, 0)));
    }
  };
  drive(0, 20, true);
  EXPECT_TRUE(vehicle.mayBeAt(other));
  drive(20, 100, false);
  EXPECT_FALSE(vehicle.mayBeAt(other));
  drive(100, 130, true);
  EXPECT_FALSE(vehicle.mayBeAt(other)) << "comes back";
}

TEST(OwnVehicle, IsKnownAroundEachLidar)
{
  OwnVehicle vehicle(1.5);
  Scan rear;
  rear.T_vehicle_lidar = poseFromYpr(-3, 0, 0, M_PI, 0, 0);
  rear.points = {{0.5F, 0.7F, 0}};  // part of the vehicle
  for (int i = 0; i < 30; ++i)
  {
    Scan scan = scanFrom(i, 0.37);
    appendScan(rear, 1, scan);
    vehicle.observe(scan);
    vehicle.addMotion(Pose(Eigen::Translation3d(0.37, 0, 0)));
  }
  EXPECT_TRUE(vehicle.mayBeAt(mast));
  EXPECT_FALSE(vehicle.mayBeAt(mast, 1));
  EXPECT_TRUE(vehicle.mayBeAt(rear.points[0], 1));
  EXPECT_FALSE(vehicle.mayBeAt(rear.points[0]));
  EXPECT_TRUE(vehicle.mayBeAt(rear.points[0], 2)) << "a lidar without scans so far";
}

TEST(OwnVehicle, MayBeEverywhereUntilTheLidarHasMoved)
{
  EXPECT_TRUE(observed(30, 0).mayBeAt(at_a_post));
  EXPECT_TRUE(observed(7, 0.37).mayBeAt(at_a_post));
  EXPECT_FALSE(observed(8, 0.37).mayBeAt(at_a_post));
}

TEST(OwnVehicle, ScansOfALidarThatStandsCountOnce)
{
  OwnVehicle vehicle = observed(20, 0.37);
  for (int i = 0; i < 100; ++i)
  {
    Scan scan = scanFrom(20, 0.37);
    scan.points.push_back({0.5F, 0.5F, 0});  // someone stands beside it
    vehicle.observe(scan);
    vehicle.addMotion(Pose::Identity());
  }
  EXPECT_FALSE(vehicle.mayBeAt({0.5F, 0.5F, 0}));
  EXPECT_TRUE(vehicle.mayBeAt(mast));
}

TEST(OwnVehicle, ATurnOnTheSpotIsMotionToo)
{
  OwnVehicle vehicle(1.5);
  for (int i = 0; i < 20; ++i)
  {
    Scan scan;
    const float angle = 0.2F * static_cast<float>(i);
    scan.points = {mast, Eigen::Vector3f(std::cos(angle), -std::sin(angle), 0)};
    vehicle.observe(scan);
    vehicle.addMotion(Pose(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ())));
  }
  EXPECT_TRUE(vehicle.mayBeAt(mast));
  EXPECT_FALSE(vehicle.mayBeAt({1, 0, 0}));
}

TEST(OwnVehicle, WithoutARangeThereIsNone)
{
  EXPECT_FALSE(observed(30, 0.37, 0).mayBeAt(mast));
  EXPECT_FALSE(OwnVehicle(0).mayBeAt({0, 0, 0}));
}

TEST(OwnVehicle, GoesOnFromItsState)
{
  const auto bytesOf = [](OwnVehicle vehicle)
  {
    StateArchive saved;
    saved(vehicle);
    return saved.bytes();
  };
  const std::string bytes = bytesOf(observed(12, 0.37));
  OwnVehicle loaded(1.5);
  StateArchive loading{std::string_view(bytes)};
  loading(loaded);
  EXPECT_TRUE(loaded.mayBeAt(mast));
  EXPECT_FALSE(loaded.mayBeAt(at_a_post));
  EXPECT_EQ(bytesOf(loaded), bytes);
}

TEST(OwnVehicle, ItsReturnsAreInNoCloud)
{
  ThreadPool pool(1);
  const PreprocessOptions options;
  const Preprocessor preprocessor(options, pool);
  Scan scan = scanFrom(0, 0);
  scan.points = {mast, at_a_post, {8, 2, 1}, {0.2F, 0.2F, 0.2F}};
  const auto sources = [&](const OwnVehicle* vehicle)
  { return preprocessor.prepare(scan, Pose::Identity(), 0.1, 0, vehicle).source; };
  const OwnVehicle known = observed(30, 0.37);
  EXPECT_EQ(sources(&known), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(sources(nullptr), std::vector<std::uint32_t>{2});
}
}  // namespace
