// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelMap.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr double tile_size = 8.0;    // side of the squares that are swapped as a whole [m]
constexpr double column_size = 1.0;  // side of the columns whose lowest voxel is the ground [m]

/** Key of the square of side `size` around (x, y) [m]. */
std::uint64_t squareOf(double x, double y, double size)
{
  return voxelKey({cellNumber(x / size), cellNumber(y / size), 0});
}

void countUp(std::uint16_t& counter)
{
  constexpr std::uint16_t most = std::numeric_limits<std::uint16_t>::max();
  counter = counter < most ? static_cast<std::uint16_t>(counter + 1) : counter;
}
}  // namespace

VoxelCell VoxelMap::cellOf(const Eigen::Vector3d& p) const
{
  return {cellNumber(p.x() / voxel_size_), cellNumber(p.y() / voxel_size_),
          cellNumber(p.z() / voxel_size_)};
}

Eigen::Vector3d VoxelMap::cornerOf(const VoxelCell& cell) const
{
  return voxel_size_ * Eigen::Vector3d(cell.x, cell.y, cell.z);
}

Eigen::Vector3d VoxelMap::centroidOf(const Voxel& voxel) const
{
  const Eigen::Vector3f offset = Eigen::Map<const Eigen::Vector3f>(voxel.corner_offset.data());
  return cornerOf(voxel.cell) + (offset / std::max<float>(voxel.points, 1)).cast<double>();
}

std::uint32_t VoxelMap::tileOf(const VoxelCell& cell) const
{
  const Eigen::Vector3d corner = cornerOf(cell);
  return tile_index_.find(squareOf(corner.x(), corner.y(), tile_size));
}

const Voxel* VoxelMap::find(const Eigen::Vector3d& p) const
{
  const VoxelCell cell = cellOf(p);
  const std::uint32_t number = tileOf(cell);
  if (number == VoxelHash::none)
  {
    return nullptr;
  }
  const VoxelTile& tile = tiles_.get(number);
  const std::uint32_t found = tile.find(cell);
  return found == VoxelHash::none ? nullptr : &tile.voxels()[found];
}

void VoxelMap::exchangeState(StateArchive& archive)
{
  archive(voxel_size_, size_, tile_index_, tiles_);
}

Voxel& VoxelMap::hit(const Eigen::Vector3d& p, std::uint32_t keyframe, std::uint8_t lidar)
{
  const VoxelCell cell = cellOf(p);
  const Eigen::Vector3d corner = cornerOf(cell);
  const auto next = static_cast<std::uint32_t>(tiles_.size());
  const std::uint32_t number =
      tile_index_.findOrInsert(squareOf(corner.x(), corner.y(), tile_size), next);
  if (number == next)
  {
    tiles_.add({});
  }
  VoxelTile& tile = tiles_.edit(number);
  const std::uint32_t found = tile.find(cell);
  Voxel& voxel = found == VoxelHash::none ? tile.add(cell) : tile.voxels()[found];
  if (found == VoxelHash::none)
  {
    voxel.number = static_cast<std::uint32_t>(size_++);
  }
  if (voxel.last_keyframe != keyframe)
  {
    discountEarlierRuns(voxel);
    voxel.last_keyframe = keyframe;
    countUp(voxel.hits);
  }
  voxel.last_lidar = lidar;
  return voxel;
}

void VoxelMap::discountEarlierRuns(Voxel& voxel) const
{
  if (voxel.last_keyframe < run_begin_ && voxel.discounted_in != run_)
  {
    voxel.hits = std::min(voxel.hits, static_cast<std::uint16_t>(earlier_hits_));
    voxel.discounted_in = run_;
    if (!rebuilding_)
    {
      voxel.observed_free = 0;
    }
  }
}

void VoxelMap::addPoint(Voxel& voxel, const Eigen::Vector3d& p, float intensity) const
{
  Eigen::Map<Eigen::Vector3f>(voxel.corner_offset.data()) +=
      (p - cornerOf(voxel.cell)).cast<float>();
  voxel.intensity += intensity;
  countUp(voxel.points);
}

void VoxelMap::carryEvidence(const Voxel& old, Voxel& voxel)
{
  // If several old voxels merge, the strongest evidence for keeping the voxel counts.
  voxel.old_hits = std::max(voxel.old_hits, old.hits);
  voxel.observed_free =
      voxel.has_evidence ? std::min(voxel.observed_free, old.observed_free) : old.observed_free;
  voxel.has_evidence = true;
  voxel.old_discounted_in = std::max(voxel.old_discounted_in, old.discounted_in);
}

void VoxelMap::mergeOldHits()
{
  for (std::size_t t = 0; t < tiles_.size(); ++t)
  {
    for (Voxel& voxel : tiles_.edit(t).voxels())
    {
      voxel.hits = std::max(voxel.hits, voxel.old_hits);
      voxel.discounted_in = std::max(voxel.discounted_in, voxel.old_discounted_in);
    }
  }
  rebuilding_ = false;
}

void VoxelMap::countObservedFree(const ScanVisibility& rays,
                                 const Pose& T_map_vehicle,
                                 const StaticMapOptions& options)
{
  const Eigen::Isometry3f T_vehicle_map = T_map_vehicle.inverse().cast<float>();
  const Eigen::Vector3d at = T_map_vehicle.translation();
  const int reach = static_cast<int>(std::ceil(options.visibility_range / tile_size));
  const auto limit = static_cast<float>(options.visibility_range * options.visibility_range);
  std::vector<std::size_t> near;  // voxels of a square within the range, which are tested together
  std::vector<Eigen::Vector3f> places;  // their centroids, vehicle frame [m]
  for (int tx = -reach; tx <= reach; ++tx)
  {
    for (int ty = -reach; ty <= reach; ++ty)
    {
      const std::uint32_t tile =
          tile_index_.find(squareOf(at.x() + tx * tile_size, at.y() + ty * tile_size, tile_size));
      if (tile == VoxelHash::none)
      {
        continue;
      }
      std::vector<Voxel>& voxels = tiles_.edit(tile).voxels();
      near.clear();
      places.clear();
      for (std::size_t i = 0; i < voxels.size(); ++i)
      {
        const Eigen::Vector3f p = T_vehicle_map * centroidOf(voxels[i]).cast<float>();
        if (p.squaredNorm() <= limit)
        {
          near.push_back(i);
          places.push_back(p);
        }
      }
      const std::vector<bool> free = rays.observeFree(
          places, static_cast<float>(voxel_size_), static_cast<float>(options.visibility_margin));
      for (std::size_t i = 0; i < near.size(); ++i)
      {
        if (free[i])
        {
          discountEarlierRuns(voxels[near[i]]);
          countUp(voxels[near[i]].observed_free);
        }
      }
    }
  }
}

bool VoxelMap::wasObservedFree(const Voxel& voxel, const StaticMapOptions& options)
{
  return options.visibility && voxel.observed_free >= options.visibility_min_views &&
         voxel.observed_free >= options.visibility_ratio * voxel.hits;
}

std::vector<bool> VoxelMap::nearGround(const std::vector<Voxel>& suspects,
                                       const StaticMapOptions& options) const
{
  // Ground of a column: the lowest voxel that was hit more than once, else the lowest voxel.
  constexpr float nothing = std::numeric_limits<float>::infinity();
  VoxelHash columns(suspects.size());
  Eigen::Vector2d low = Eigen::Vector2d::Constant(static_cast<double>(nothing));
  Eigen::Vector2d high = -low;
  for (const Voxel& voxel : suspects)
  {
    const Eigen::Vector3d c = centroidOf(voxel);
    columns.findOrInsert(squareOf(c.x(), c.y(), column_size),
                         static_cast<std::uint32_t>(columns.size()));
    const Eigen::Vector2d corner = cornerOf(voxel.cell).head<2>();
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  std::vector<float> sure(columns.size(), nothing);
  std::vector<float> any(columns.size(), nothing);
  // Visits the tiles whose voxels may have their centroid in one of the columns: a voxel belongs to
  // the tile of its corner.
  const double reach = column_size + voxel_size_;
  const auto tileAt = [](double v) { return cellNumber(v / tile_size); };
  for (int x = tileAt(low.x() - 1.01 * reach); x <= tileAt(high.x() + reach); ++x)
  {
    for (int y = tileAt(low.y() - 1.01 * reach); y <= tileAt(high.y() + reach); ++y)
    {
      const std::uint32_t tile = tile_index_.find(voxelKey({x, y, 0}));
      if (tile == VoxelHash::none)
      {
        continue;
      }
      for (const Voxel& voxel : tiles_.get(tile).voxels())
      {
        const Eigen::Vector3d c = centroidOf(voxel);
        const std::uint32_t column = columns.find(squareOf(c.x(), c.y(), column_size));
        if (column != VoxelHash::none)
        {
          const auto z = static_cast<float>(c.z());
          any[column] = std::min(any[column], z);
          sure[column] = voxel.hits > 1 ? std::min(sure[column], z) : sure[column];
        }
      }
    }
  }
  std::vector<bool> result;
  for (const Voxel& voxel : suspects)
  {
    const Eigen::Vector3d c = centroidOf(voxel);
    const std::uint32_t column = columns.find(squareOf(c.x(), c.y(), column_size));
    const float floor = sure[column] < nothing ? sure[column] : any[column];
    result.push_back(c.z() <= static_cast<double>(floor) + options.ground_clearance);
  }
  return result;
}

void VoxelMap::forEachCleaned(const StaticMapOptions& options,
                              const std::function<void(const Voxel&)>& use) const
{
  for (std::size_t t = 0; t < tiles_.size(); ++t)
  {
    std::vector<Voxel> suspects;
    for (const Voxel& voxel : tiles_.get(t).voxels())
    {
      if (voxel.hits >= options.min_hits)
      {
        wasObservedFree(voxel, options) ? suspects.push_back(voxel) : use(voxel);
      }
    }
    const std::vector<bool> stay =
        suspects.empty() ? std::vector<bool>() : nearGround(suspects, options);
    for (std::size_t i = 0; i < suspects.size(); ++i)
    {
      if (stay[i])
      {
        use(suspects[i]);
      }
    }
  }
}
}  // namespace dyslam
