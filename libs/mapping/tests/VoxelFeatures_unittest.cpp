// SPDX-License-Identifier: BSD-3-Clause
#include "../src/VoxelFeatures.h"

#include <gtest/gtest.h>

using namespace dyslam;

namespace
{
/** Features of the voxels of points that are all above the ground, far from each other or in cells
 * of 0.4 m that touch. */
std::vector<VoxelFeatures> featuresOf(const std::vector<Eigen::Vector3f>& points)
{
  const Segments segments = findSegments(points, std::vector<bool>(points.size(), true), 0.2, 0.4);
  return voxelFeatures(segments, std::vector<VoxelEvidence>(segments.first_point.size()), points,
                       std::vector<float>(points.size(), 1.0F), Eigen::Vector3f::Zero());
}

/** Points every 0.2 m of a rectangle, turned about z; far from the origin, as in a long run.
 * \param length, width, height sides of the rectangle [m] \param yaw heading [rad] */
std::vector<Eigen::Vector3f> block(float length, float width, float height, float yaw)
{
  const Eigen::Matrix3f R = Eigen::AngleAxisf(yaw, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  constexpr float step = 0.2F;
  std::vector<Eigen::Vector3f> points;
  for (float x = 0; x <= length; x += step)
  {
    for (float y = 0; y <= width; y += step)
    {
      for (float z = 0; z <= height; z += step)
      {
        points.emplace_back(Eigen::Vector3f(3000, -2000, 1) + R * Eigen::Vector3f(x, y, z));
      }
    }
  }
  return points;
}
}  // namespace

TEST(VoxelFeatures, RowsAreLongAndThinAtAnyHeading)
{
  for (const float yaw : {0.0F, 0.5F, 1.57F, 2.4F})
  {
    const VoxelFeatures fence = featuresOf(block(9, 0, 1, yaw)).front();
    EXPECT_NEAR(fence.row_length, 9, 0.4) << yaw;
    EXPECT_LT(fence.row_width, 0.1) << yaw;
    EXPECT_NEAR(fence.segment_height, 1, 0.21) << yaw;
  }
}

TEST(VoxelFeatures, AVehicleIsNoRow)
{
  for (const float yaw : {0.0F, 0.8F})
  {
    const VoxelFeatures truck = featuresOf(block(8, 2.4F, 2, yaw)).front();
    EXPECT_NEAR(truck.row_length, 8, 0.5) << yaw;
    EXPECT_NEAR(truck.row_width, 2.4, 0.4) << yaw;
  }
}

TEST(VoxelFeatures, SegmentsHaveShapesOfTheirOwn)
{
  std::vector<Eigen::Vector3f> points = block(6, 0, 0, 0);
  const std::size_t row = points.size();
  points.emplace_back(3000, -1990, 1);  // by itself
  const std::vector<VoxelFeatures> features = featuresOf(points);
  ASSERT_EQ(features.back().point, row);
  EXPECT_EQ(features.back().row_length, 0);
  EXPECT_EQ(features.back().length, 0);
  EXPECT_NEAR(features.front().row_length, 6, 0.4);
  EXPECT_NEAR(features.front().length, 6, 0.21);
}
