// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../src/ScanVisibility.h"

namespace dyslam
{
namespace
{
constexpr float degree = 0.017453293F;

/** Returns of a sensor at the origin. \param range of a ray, infinite without a return */
Cloud cloudOf(float ring_step,
              float column_step,
              const std::function<float(const Eigen::Vector3f&)>& range)
{
  Cloud cloud;
  for (float elevation = -15 * degree; elevation < 15.01F * degree; elevation += ring_step)
  {
    for (float azimuth = -60 * degree; azimuth < 60 * degree; azimuth += column_step)
    {
      const Eigen::Vector3f ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      if (std::isfinite(range(ray)))
      {
        cloud.points.emplace_back(range(ray) * ray);
      }
    }
  }
  return cloud;
}

Evidence at(const Cloud& cloud, const Eigen::Vector3f& voxel)
{
  const VisibilityImage image(cloud, {0, cloud.size(), 0, Pose::Identity(), 0});
  Evidence evidence = Evidence::none;
  image.evaluate(&voxel, 1, Eigen::Isometry3f::Identity(), 0.2F, 0.5F, &evidence);
  return evidence;
}

/** A point ahead at an elevation between the rings of a sensor with 2 degrees between rings. */
Eigen::Vector3f betweenRings(float distance)
{
  return {distance, 0, distance * std::tan(2 * degree)};
}

TEST(VisibilityImage, RaysThroughAVoxelObserveItFree)
{
  const Cloud far = cloudOf(0.4F * degree, 0.2F * degree, [](const auto&) { return 40.0F; });
  EXPECT_EQ(at(far, {20, 0.03F, 0}), Evidence::free);
  EXPECT_EQ(at(far, {40, 0, 0}), Evidence::occupied);
  EXPECT_EQ(at(far, {50, 0, 0}), Evidence::occluded);
}

TEST(VisibilityImage, RaysAboveAndBelowEncloseAVoxelBetweenRings)
{
  const Cloud far = cloudOf(2 * degree, 0.4F * degree, [](const auto&) { return 40.0F; });
  EXPECT_EQ(at(far, betweenRings(20)), Evidence::enclosed);
  EXPECT_EQ(at(far, betweenRings(40)), Evidence::occupied) << "the wall goes on between the rings";
  EXPECT_EQ(at(far, betweenRings(50)), Evidence::occluded);
}

TEST(VisibilityImage, AVoxelIsNotEnclosedBesideWhatRaysHit)
{
  // A low wall at 20 m: the ring above passes over the wall, the ring below ends there.
  const auto low_wall = [](const Eigen::Vector3f& ray)
  { return ray.z() < 2 * degree ? 20 / ray.x() : 40.0F; };
  EXPECT_EQ(at(cloudOf(2 * degree, 0.4F * degree, low_wall), betweenRings(20)), Evidence::occupied);
}

TEST(VisibilityImage, SkyProvesNothing)
{
  const auto sky_above = [](const Eigen::Vector3f& ray)
  { return ray.z() < 2 * degree ? 40.0F : std::numeric_limits<float>::infinity(); };
  EXPECT_EQ(at(cloudOf(2 * degree, 0.4F * degree, sky_above), betweenRings(20)), Evidence::none);
}

TEST(VisibilityImage, OfAVoxelAtTheSensorNothingIsKnown)
{
  const Cloud far = cloudOf(0.4F * degree, 0.2F * degree, [](const auto&) { return 40.0F; });
  const VisibilityImage image(far, {0, far.size(), 0, Pose::Identity(), 0});
  const std::vector<Eigen::Vector3f> voxels{Eigen::Vector3f::Zero(), {0.4F, 0, 0}};
  std::vector<Evidence> seen(2, Evidence::free);
  image.at(voxels.data(), voxels.size(), 0.2F, 0.5F, seen.data());
  EXPECT_EQ(seen, std::vector<Evidence>(2, Evidence::none));
  EXPECT_EQ(at(far, {0, 0, 0}), Evidence::none);
}

TEST(VisibilityImage, AWallAtGrazingIncidenceIsNotFree)
{
  // A wall along x at 3 m to the left: next to a ray that ended at the voxel, others end metres
  // before and behind it.
  const auto beside = [](const Eigen::Vector3f& ray) { return ray.y() > 0.05F ? 3 / ray.y() : 60; };
  const Cloud sparse = cloudOf(0.4F * degree, 0.85F * degree, beside);
  for (float x = 10; x < 25; x += 0.1F)
  {
    const Evidence seen = at(sparse, {x, 3, 0.4F});
    EXPECT_NE(seen, Evidence::free) << x;
    EXPECT_NE(seen, Evidence::enclosed) << x;
  }
}

/** A scan of two lidars, the second one 2 m to the left of the first. \param first, second range of
 * each lidar's rays */
struct TwoLidars
{
  explicit TwoLidars(const std::function<float(const Eigen::Vector3f&)>& first,
                     const std::function<float(const Eigen::Vector3f&)>& second)
      : cloud(cloudOf(0.4F * degree, 0.2F * degree, first))
  {
    ScanPart part;
    part.begin = cloud.size();
    part.T_scan_lidar.translation() = Eigen::Vector3d(0, 2, 0);
    scan.parts = {part};
    for (const auto& p : cloudOf(0.4F * degree, 0.2F * degree, second).points)
    {
      cloud.points.emplace_back(p + Eigen::Vector3f(0, 2, 0));
    }
    for (std::size_t i = 0; i < cloud.size(); ++i)
    {
      cloud.source.push_back(static_cast<std::uint32_t>(i));
    }
    scan.points = cloud.points;
  }

  [[nodiscard]] Evidence at(const Eigen::Vector3f& voxel) const
  {
    Evidence evidence = Evidence::none;
    ScanVisibility(scan, cloud)
        .evaluate(&voxel, 1, Eigen::Isometry3f::Identity(), 0.2F, 0.5F, &evidence);
    return evidence;
  }

  Scan scan;
  Cloud cloud;
};

TEST(ScanVisibility, RaysStartAtTheLidarThatMeasuredThem)
{
  // A post before the first lidar hides a voxel that rays of the second lidar pass through.
  const auto post = [](const Eigen::Vector3f& ray)
  { return std::abs(ray.y()) < 0.03F ? 5.0F : 40.0F; };
  const TwoLidars scan(post, [](const auto&) { return 40.0F; });
  EXPECT_EQ(scan.at({20, 0.03F, 0}), Evidence::free);
  EXPECT_EQ(scan.at({5, 0, 0}), Evidence::occupied) << "the first one's returns, seen by it alone";
  const ScanVisibility first_only(Scan(), cloudOf(0.4F * degree, 0.2F * degree, post));
  EXPECT_FALSE(first_only.observeFree({{20, 0.03F, 0}}, 0.2F, 0.5F)[0]);
  EXPECT_TRUE(ScanVisibility(scan.scan, scan.cloud).observeFree({{20, 0.03F, 0}}, 0.2F, 0.5F)[0]);
}

TEST(ScanVisibility, WhatOneLidarHitsIsNotFree)
{
  // The second lidar hits a board edge-on, which the rays of the first pass by.
  const TwoLidars scan([](const auto&) { return 40.0F; }, [](const Eigen::Vector3f& ray)
                       { return std::abs(ray.y() + 0.1F) < 0.01F ? 20.0F : 40.0F; });
  EXPECT_EQ(scan.at({19.9F, 0, 0}), Evidence::occupied);
  EXPECT_FALSE(ScanVisibility(scan.scan, scan.cloud).observeFree({{19.9F, 0, 0}}, 0.2F, 0.5F)[0]);
}
}  // namespace
}  // namespace dyslam
