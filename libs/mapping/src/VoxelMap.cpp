// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelMap.h"

#include <dyslam/core/StateArchive.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr double block_size = 8.0;   // voxels are listed by squares of this side [m]
constexpr float column_size = 1.0F;  // of the columns whose lowest voxel is the ground [m]

/** 2D cell of a point in squares, as a key. */
std::uint64_t squareOf(double x, double y, double size)
{
  return voxelKey({static_cast<std::int32_t>(std::floor(x / size)),
                   static_cast<std::int32_t>(std::floor(y / size)), 0});
}

void countUp(std::uint16_t& counter)
{
  constexpr std::uint16_t most = std::numeric_limits<std::uint16_t>::max();
  counter = counter < most ? static_cast<std::uint16_t>(counter + 1) : counter;
}
}  // namespace

VoxelCell VoxelMap::cellOf(const Eigen::Vector3d& p) const
{
  return {static_cast<std::int32_t>(std::floor(p.x() / voxel_size_)),
          static_cast<std::int32_t>(std::floor(p.y() / voxel_size_)),
          static_cast<std::int32_t>(std::floor(p.z() / voxel_size_))};
}

Eigen::Vector3d VoxelMap::cornerOf(const VoxelCell& cell) const
{
  return voxel_size_ * Eigen::Vector3d(cell.x, cell.y, cell.z);
}

Eigen::Vector3d VoxelMap::centroidOf(const Voxel& voxel) const
{
  return cornerOf(voxel.cell) +
         (voxel.corner_offset / std::max<float>(voxel.points, 1)).cast<double>();
}

std::uint32_t VoxelMap::find(const Eigen::Vector3d& p) const
{
  return index_.find(voxelKey(cellOf(p)));
}

void VoxelMap::list(const VoxelCell& cell, std::uint32_t number)
{
  const Eigen::Vector3d corner = cornerOf(cell);
  const auto next_block = static_cast<std::uint32_t>(blocks_.size());
  const std::uint32_t block =
      block_index_.findOrInsert(squareOf(corner.x(), corner.y(), block_size), next_block);
  if (block == next_block)
  {
    blocks_.emplace_back();
  }
  blocks_[block].push_back(number);
}

void VoxelMap::exchangeState(StateArchive& archive)
{
  archive(voxel_size_, voxels_);
  if (archive.isLoading())
  {
    index_ = VoxelHash(voxels_.size());
    block_index_ = VoxelHash();
    blocks_.clear();
    for (std::size_t i = 0; i < voxels_.size(); ++i)
    {
      (void)index_.findOrInsert(voxelKey(voxels_[i].cell), static_cast<std::uint32_t>(i));
      list(voxels_[i].cell, static_cast<std::uint32_t>(i));
    }
  }
}

Voxel& VoxelMap::hit(const Eigen::Vector3d& p, std::uint32_t keyframe)
{
  const VoxelCell cell = cellOf(p);
  const auto next = static_cast<std::uint32_t>(voxels_.size());
  const std::uint32_t found = index_.findOrInsert(voxelKey(cell), next);
  if (found == next)
  {
    Voxel voxel;
    voxel.cell = cell;
    voxels_.push_back(voxel);
    list(cell, found);
  }
  Voxel& voxel = voxels_[found];
  if (voxel.last_keyframe != keyframe)
  {
    voxel.last_keyframe = keyframe;
    countUp(voxel.hits);
  }
  return voxel;
}

void VoxelMap::addPoint(Voxel& voxel, const Eigen::Vector3d& p, float intensity) const
{
  voxel.corner_offset += (p - cornerOf(voxel.cell)).cast<float>();
  voxel.intensity += intensity;
  countUp(voxel.points);
}

void VoxelMap::carryEvidence(const Voxel& old, Voxel& voxel)
{
  // Of several old voxels, what speaks most for staying.
  voxel.old_hits = std::max(voxel.old_hits, old.hits);
  voxel.observed_free =
      voxel.has_evidence ? std::min(voxel.observed_free, old.observed_free) : old.observed_free;
  voxel.has_evidence = true;
}

void VoxelMap::mergeOldHits()
{
  for (Voxel& voxel : voxels_)
  {
    voxel.hits = std::max(voxel.hits, voxel.old_hits);
  }
}

void VoxelMap::countObservedFree(const VisibilityImage& image,
                                 const Pose& T_map_vehicle,
                                 const StaticMapOptions& options)
{
  const Eigen::Isometry3f T_vehicle_map = T_map_vehicle.inverse().cast<float>();
  const Eigen::Vector3d at = T_map_vehicle.translation();
  const int reach = static_cast<int>(std::ceil(options.visibility_range / block_size));
  const auto limit = static_cast<float>(options.visibility_range * options.visibility_range);
  for (int bx = -reach; bx <= reach; ++bx)
  {
    for (int by = -reach; by <= reach; ++by)
    {
      const std::uint32_t block = block_index_.find(
          squareOf(at.x() + bx * block_size, at.y() + by * block_size, block_size));
      if (block == VoxelHash::none)
      {
        continue;
      }
      for (const std::uint32_t v : blocks_[block])
      {
        Voxel& voxel = voxels_[v];
        const Eigen::Vector3f p = T_vehicle_map * centroidOf(voxel).cast<float>();
        if (p.squaredNorm() <= limit &&
            image.observesFree(p, static_cast<float>(voxel_size_),
                               static_cast<float>(options.visibility_margin)))
        {
          countUp(voxel.observed_free);
        }
      }
    }
  }
}

/** Height of the ground by column: the lowest voxel hit more than once, else the lowest. */
std::vector<float> VoxelMap::groundHeights(VoxelHash& columns) const
{
  constexpr float nothing = std::numeric_limits<float>::infinity();
  std::vector<float> sure;
  std::vector<float> any;
  for (const Voxel& voxel : voxels_)
  {
    const Eigen::Vector3d c = centroidOf(voxel);
    const auto next = static_cast<std::uint32_t>(any.size());
    const std::uint32_t column = columns.findOrInsert(squareOf(c.x(), c.y(), column_size), next);
    if (column == next)
    {
      sure.push_back(nothing);
      any.push_back(nothing);
    }
    const auto z = static_cast<float>(c.z());
    any[column] = std::min(any[column], z);
    sure[column] = voxel.hits > 1 ? std::min(sure[column], z) : sure[column];
  }
  for (std::size_t i = 0; i < any.size(); ++i)
  {
    any[i] = sure[i] < nothing ? sure[i] : any[i];
  }
  return any;
}

std::vector<bool> VoxelMap::cleaned(const StaticMapOptions& options) const
{
  VoxelHash columns;
  const std::vector<float> ground =
      options.visibility ? groundHeights(columns) : std::vector<float>();
  std::vector<bool> kept(voxels_.size());
  for (std::size_t i = 0; i < voxels_.size(); ++i)
  {
    const Voxel& voxel = voxels_[i];
    kept[i] = voxel.hits >= options.min_hits;
    const bool observed_free = options.visibility &&
                               voxel.observed_free >= options.visibility_min_views &&
                               voxel.observed_free >= options.visibility_ratio * voxel.hits;
    if (observed_free)
    {
      const Eigen::Vector3d c = centroidOf(voxel);
      const float floor = ground[columns.find(squareOf(c.x(), c.y(), column_size))];
      kept[i] = kept[i] && c.z() <= static_cast<double>(floor) + options.ground_clearance;
    }
  }
  return kept;
}
}  // namespace dyslam
