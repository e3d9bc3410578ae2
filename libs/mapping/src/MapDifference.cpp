// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/MapDifference.h>

#include <cstdint>

namespace dyslam
{
std::vector<Eigen::Vector3f> removedPoints(const MapPoints& all, const StaticMap& cleaned)
{
  std::vector<bool> kept(cleaned.voxelCount(), false);
  for (const std::uint32_t voxel : cleaned.points().voxel)
  {
    kept[voxel] = true;
  }
  std::vector<Eigen::Vector3f> removed;
  for (const auto& p : all.points)
  {
    const std::uint32_t voxel = cleaned.voxelAt(p.cast<double>());
    if (voxel == VoxelHash::none || !kept[voxel])
    {
      removed.push_back(p);
    }
  }
  return removed;
}
}  // namespace dyslam
