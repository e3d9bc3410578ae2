// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Finds voxels of posts, poles and trunks: thin upright columns with free space around.
 *
 * Rays hit posts in some scans and pass beside them in others, which looks as if they came and
 * went. */
class Posts
{
 public:
  /** \param voxels a point of each voxel, odometry frame, z up [m]; kept by reference */
  explicit Posts(const std::vector<Eigen::Vector3f>& voxels);

  /** Whether the voxel belongs to a post: the voxels within 0.4 m horizontally are higher than 1.2
   * m together and spread by less than 0.12 m (standard deviation), and within 1 m there are at
   * most half as many others. */
  [[nodiscard]] bool contain(std::size_t voxel) const;

 private:
  const std::vector<Eigen::Vector3f>& voxels_;
  VoxelHash squares_;                // from voxelKey() of a square to its first voxel
  std::vector<std::uint32_t> next_;  // next voxel of the same square, or VoxelHash::none
};
}  // namespace dyslam
