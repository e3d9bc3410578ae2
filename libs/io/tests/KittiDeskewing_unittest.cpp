// SPDX-License-Identifier: BSD-3-Clause
#include "../src/kitti/KittiDeskewing.h"

#include <dyslam/formats/ScanFiles.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** Pose of a lidar that moves along a screw: 12 m/s and 20 deg/s, with some roll and pitch. */
Pose poseAt(double time)
{
  Vector6 velocity;
  velocity << 12, 0.5, -0.2, 0.02, -0.03, 0.35;
  return expSE3(time * velocity);
}

const std::vector<Eigen::Vector3d>& worldPoints()
{
  static const std::vector<Eigen::Vector3d> points{
      {20, 5, 1}, {-15, 8, 0.5}, {3, -30, 2}, {40, 0, -1.5}, {-6, -4, 0}};
  return points;
}

/** The points as the lidar sees them, each at its own time after the stamp [s]. */
Scan seenAt(double stamp, const std::vector<float>& times)
{
  Scan scan;
  scan.stamp = stamp;
  scan.time = times;
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    const Pose T_world_lidar = poseAt(stamp + static_cast<double>(times[i]));
    scan.points.push_back((T_world_lidar.inverse() * worldPoints()[i]).cast<float>());
    scan.intensity.push_back(0.5F);
  }
  return scan;
}

/** Largest distance of the points in a file from where the lidar sees them at the stamp [m]. */
double errorOf(const std::string& file, double stamp)
{
  const Scan written = readCloud(file);
  double largest = written.size() == worldPoints().size() ? 0 : 1e9;
  for (std::size_t i = 0; i < written.size(); ++i)
  {
    const Eigen::Vector3d expected = poseAt(stamp).inverse() * worldPoints()[i];
    largest = std::max(largest, (written.points[i].cast<double>() - expected).norm());
  }
  return largest;
}
}  // namespace

TEST(KittiDeskewing, MovesPointsToTheStampAlongThePoses)
{
  const TestFolder folder;
  const std::vector<float> times{-0.05F, -0.02F, 0, 0.03F, 0.05F};
  const std::vector<double> stamps{0, 0.1, 0.2, 0.5, 0.6};  // two scans are missing
  KittiDeskewing deskewing;
  for (std::size_t i = 0; i < stamps.size(); ++i)
  {
    deskewing.add(seenAt(stamps[i], times), poseAt(stamps[i]),
                  folder.file(std::to_string(i) + ".bin"));
  }
  deskewing.finish();
  EXPECT_EQ(0U, deskewing.withoutTimes());
  for (std::size_t i = 0; i < stamps.size(); ++i)
  {
    EXPECT_LT(errorOf(folder.file(std::to_string(i) + ".bin"), stamps[i]), 2e-3) << i;
  }
  writeBin(folder.file("raw.bin"), seenAt(0.1, times).points, seenAt(0.1, times).intensity);
  EXPECT_GT(errorOf(folder.file("raw.bin"), 0.1), 0.5) << "as recorded";
}

TEST(KittiDeskewing, MotionBesideAGapIsThatOfTheOtherSide)
{
  const TestFolder folder;
  const std::vector<float> times{-0.05F, -0.02F, 0, 0.03F, 0.05F};
  KittiDeskewing deskewing;
  deskewing.add(seenAt(0, times), poseAt(0), folder.file("0.bin"));
  deskewing.add(seenAt(0.1, times), poseAt(0.1), folder.file("1.bin"));
  deskewing.add(seenAt(2, times), Pose::Identity(), folder.file("2.bin"));  // turned back meanwhile
  deskewing.finish();
  EXPECT_LT(errorOf(folder.file("0.bin"), 0), 2e-3);
  EXPECT_LT(errorOf(folder.file("1.bin"), 0.1), 2e-3);
}

TEST(KittiDeskewing, LeavesWhatCannotBeDeskewed)
{
  const TestFolder folder;
  Scan scan = seenAt(0, {0.05F, 0.05F, 0.05F, 0.05F});
  scan.points[1] = Eigen::Vector3f::Zero();
  scan.points[2].x() = std::numeric_limits<float>::infinity();
  scan.time[3] = std::nanf("");
  Scan untimed = scan;
  untimed.stamp = 0.1;
  untimed.time.clear();
  Scan empty;
  empty.stamp = 0.2;
  KittiDeskewing deskewing;
  deskewing.finish();
  deskewing.add(scan, poseAt(0), folder.file("0.bin"));
  deskewing.add(untimed, poseAt(0.1), folder.file("1.bin"));
  deskewing.add(empty, poseAt(0.2), folder.file("2.bin"));
  deskewing.finish();
  const Scan written = readCloud(folder.file("0.bin"));
  ASSERT_EQ(4U, written.size());
  EXPECT_GT((written.points[0] - scan.points[0]).norm(), 0.5F);
  EXPECT_EQ(written.points[1], scan.points[1]);
  EXPECT_EQ(written.points[2], scan.points[2]);
  EXPECT_EQ(written.points[3], scan.points[3]);
  EXPECT_EQ(readCloud(folder.file("1.bin")).points, untimed.points);
  EXPECT_EQ(0U, readCloud(folder.file("2.bin")).size());
  EXPECT_EQ(2U, deskewing.withoutTimes());
}

TEST(KittiDeskewing, SweptScansHaveDifferingTimes)
{
  Scan scan;
  EXPECT_FALSE(isSwept(scan));
  scan.points.resize(2, Eigen::Vector3f::Ones());
  scan.time = {0, 0};
  EXPECT_FALSE(isSwept(scan));
  scan.time = {std::nanf(""), 0.1F};
  EXPECT_FALSE(isSwept(scan));
  scan.time = {0, 0.1F};
  EXPECT_TRUE(isSwept(scan));
}
}  // namespace dyslam
