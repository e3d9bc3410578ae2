// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelTile.h"

#include <dyslam/base/Bytes.h>

namespace dyslam
{
std::size_t VoxelTile::slotOf(const VoxelCell& cell) const
{
  const std::size_t mask = slots_.size() - 1;
  const std::uint64_t mixed = voxelKey(cell) * 0x9E3779B97F4A7C15ULL;
  for (auto i = static_cast<std::size_t>(mixed >> 32U);; ++i)
  {
    const std::uint32_t voxel = slots_[i & mask];
    if (voxel == VoxelHash::none)
    {
      return i & mask;
    }
    const VoxelCell& c = voxels_[voxel].cell;
    if (c.x == cell.x && c.y == cell.y && c.z == cell.z)
    {
      return i & mask;
    }
  }
}

void VoxelTile::index(std::size_t voxels)
{
  constexpr std::size_t least = 16;
  std::size_t size = least;
  while (size < 2 * voxels)
  {
    size *= 2;
  }
  if (size <= slots_.size())
  {
    return;
  }
  slots_.assign(size, VoxelHash::none);
  for (std::size_t i = 0; i < voxels_.size(); ++i)
  {
    slots_[slotOf(voxels_[i].cell)] = static_cast<std::uint32_t>(i);
  }
}

Voxel& VoxelTile::add(const VoxelCell& cell)
{
  index(voxels_.size() + 1);
  slots_[slotOf(cell)] = static_cast<std::uint32_t>(voxels_.size());
  voxels_.emplace_back();
  voxels_.back().cell = cell;
  return voxels_.back();
}

std::string VoxelTile::toBytes() const
{
  std::string bytes;
  appendBytes(bytes, voxels_);
  return bytes;
}

VoxelTile VoxelTile::fromBytes(std::string_view bytes)
{
  VoxelTile tile;
  takeBytes(bytes, tile.voxels_);
  tile.index(tile.voxels_.size());
  return tile;
}
}  // namespace dyslam
