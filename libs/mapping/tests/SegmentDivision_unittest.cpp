// SPDX-License-Identifier: BSD-3-Clause
#include "../src/SegmentDivision.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr float spacing = 0.2F;  // of the points, one per voxel [m]
constexpr float person_x = 8.1F;
constexpr float person_y = 0.5F;  // in cells that touch those of the wall

/** Points of one scan, their segments, and the evidence of its voxels. */
struct Scene
{
  std::vector<Eigen::Vector3f> points;
  std::vector<VoxelEvidence> evidence;
  Segments segments;
};

/** A wall along x, and a person beside it. \param wall_length [m] \param change confidence that
 * the person's voxels were free before \param person_height [m] */
Scene personAtWall(float wall_length, float change, float person_height = 1.6F)
{
  Scene scene;
  const auto add = [&](float x, float y, float z, float change_before)
  {
    scene.points.emplace_back(x + 0.01F, y + 0.01F, z + 0.01F);
    VoxelEvidence e;
    e.known = 1;
    e.change_before = change_before;
    scene.evidence.push_back(e);
  };
  const auto steps = [](float length) { return static_cast<int>(std::lround(length / spacing)); };
  for (int i = 0; i < steps(wall_length); ++i)
  {
    for (int k = 0; k < steps(3.0F); ++k)
    {
      add(spacing * static_cast<float>(i), 0, spacing * static_cast<float>(k), 0);
    }
  }
  for (int i = 0; i < 2; ++i)
  {
    for (int k = 0; k < steps(person_height); ++k)
    {
      add(person_x + spacing * static_cast<float>(i), person_y, spacing * static_cast<float>(k),
          change);
    }
  }
  scene.segments =
      findSegments(scene.points, std::vector<bool>(scene.points.size(), true), spacing, 0.4);
  return scene;
}

/** Number of voxels of the person that are in another segment than the wall's first voxel. */
std::size_t divided(const Scene& scene)
{
  std::size_t count = 0;
  for (std::size_t v = 0; v < scene.segments.segment_of_voxel.size(); ++v)
  {
    const bool of_person = scene.points[scene.segments.first_point[v]].y() > 0.4F;
    const bool apart =
        scene.segments.segment_of_voxel[v] != scene.segments.segment_of_voxel.front();
    EXPECT_TRUE(of_person || !apart) << "the wall stays whole";
    count += apart ? 1 : 0;
  }
  return count;
}

TEST(SegmentDivision, WhoWalksAlongAWallIsASegmentOfItsOwn)
{
  Scene scene = personAtWall(25, 1);
  ASSERT_EQ(scene.segments.segments, 1U) << "the person touches the wall";
  EXPECT_TRUE(divideLargeSegments(scene.evidence, scene.points, scene.segments));
  EXPECT_EQ(scene.segments.segments, 2U);
  EXPECT_EQ(divided(scene), 16U);
}

TEST(SegmentDivision, WhatDidNotChangeStaysWithTheWall)
{
  Scene scene = personAtWall(25, 0.4F);
  EXPECT_FALSE(divideLargeSegments(scene.evidence, scene.points, scene.segments));
  EXPECT_EQ(scene.segments.segments, 1U);
}

TEST(SegmentDivision, AFewVoxelsStayWithTheWall)
{
  Scene scene = personAtWall(25, 1, 0.6F);
  EXPECT_FALSE(divideLargeSegments(scene.evidence, scene.points, scene.segments));
  EXPECT_EQ(scene.segments.segments, 1U);
}

TEST(SegmentDivision, SegmentsOfTheSizeOfAVehicleStayWhole)
{
  Scene scene = personAtWall(15, 1);
  EXPECT_FALSE(divideLargeSegments(scene.evidence, scene.points, scene.segments));
  EXPECT_EQ(scene.segments.segments, 1U);
}
}  // namespace
}  // namespace dyslam
