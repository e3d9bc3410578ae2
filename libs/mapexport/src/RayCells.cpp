// SPDX-License-Identifier: BSD-3-Clause
#include "RayCells.h"

namespace dyslam
{
void CellSet::clear()
{
  index_.clear();
  blocks_.clear();
  corners_.clear();
  last_ = VoxelHash::none;
}

octomap::OcTreeKey CellSet::cornerOf(const octomap::OcTreeKey& key)
{
  const auto corner = [&](unsigned axis)
  { return static_cast<octomap::key_type>(key[axis] / side * side); };
  return {corner(0), corner(1), corner(2)};
}

std::uint32_t CellSet::blockOf(const octomap::OcTreeKey& key)
{
  const octomap::OcTreeKey at = cornerOf(key);
  if (last_ != VoxelHash::none && corners_[last_] == at)
  {
    return last_;
  }
  const auto next = static_cast<std::uint32_t>(corners_.size());
  last_ = index_.findOrInsert(voxelKey({at[0], at[1], at[2]}), next);
  if (last_ == next)
  {
    blocks_.push_back({});
    corners_.push_back(at);
  }
  return last_;
}

bool CellSet::insert(const octomap::OcTreeKey& key)
{
  const std::uint32_t bit = bitOf(key);
  std::uint64_t& word = blocks_[blockOf(key)][bit / 64];
  const std::uint64_t mask = std::uint64_t{1} << (bit % 64);
  const bool is_new = (word & mask) == 0;
  word |= mask;
  return is_new;
}

bool CellSet::contains(const octomap::OcTreeKey& key) const
{
  const octomap::OcTreeKey at = cornerOf(key);
  const std::uint32_t block = index_.find(voxelKey({at[0], at[1], at[2]}));
  const std::uint32_t bit = bitOf(key);
  return block != VoxelHash::none && (blocks_[block][bit / 64] >> (bit % 64) & 1U) != 0;
}
}  // namespace dyslam
