// SPDX-License-Identifier: BSD-3-Clause
#include "../src/RayHistory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace dyslam
{
namespace
{
const Eigen::Vector3f observed_voxel(10, 0, 0);

/** A scan of a sensor at the origin with returns at one distance ahead. */
ScanVisibility wallAt(float distance)
{
  Cloud cloud;
  for (int row = -20; row <= 20; ++row)
  {
    for (int col = -20; col <= 20; ++col)
    {
      const float elevation = 0.005F * static_cast<float>(row);
      const float azimuth = 0.005F * static_cast<float>(col);
      cloud.points.emplace_back(distance * Eigen::Vector3f(std::cos(elevation) * std::cos(azimuth),
                                                           std::cos(elevation) * std::sin(azimuth),
                                                           std::sin(elevation)));
    }
  }
  return {Scan(), cloud};
}

/** Ray counts of 40 later scans at the voxel. \param free whether a scan, by its number, saw a wall
 * behind the voxel instead of one in it */
RayCounts countsAt(const std::function<bool(std::size_t)>& free, RayEffort effort)
{
  static const ScanVisibility wall = wallAt(10);
  static const ScanVisibility behind = wallAt(20);
  std::vector<OtherScan> others;
  for (std::size_t i = 0; i < 40; ++i)
  {
    others.push_back({free(i) ? &behind : &wall, Eigen::Isometry3f::Identity(), true});
  }
  ThreadPool pool(1);
  return countRays(others, {observed_voxel}, {effort}, 0.1F, 0.5F, pool).front();
}

TEST(RayHistory, AFewScansSufficeForAVoxelThatWasNeverFree)
{
  const auto never = [](std::size_t) { return false; };
  EXPECT_EQ(countsAt(never, RayEffort::all).occupied, 40);
  EXPECT_EQ(countsAt(never, RayEffort::if_needed).occupied, 14);
  EXPECT_EQ(countsAt(never, RayEffort::if_needed).free, 0);
  EXPECT_EQ(countsAt(never, RayEffort::few).occupied, 14);
}

TEST(RayHistory, AllScansAreEvaluatedAtAVoxelThatWasFree)
{
  const auto later = [](std::size_t i) { return i >= 20; };
  const RayCounts all = countsAt(later, RayEffort::all);
  const RayCounts needed = countsAt(later, RayEffort::if_needed);
  EXPECT_EQ(all.free, 20);
  EXPECT_EQ(all.change_after, 20);
  EXPECT_EQ(needed.free, all.free);
  EXPECT_EQ(needed.occupied, all.occupied);
  EXPECT_EQ(needed.change_after, all.change_after);
  EXPECT_EQ(countsAt(later, RayEffort::few).free, 7);  // of the scans 0, 3, ..., 39
}
}  // namespace
}  // namespace dyslam
