// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>
#include <octomap/OcTreeKey.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** A set of octomap's cells in blocks of 8 x 8 x 8 bits: the cells along a ray are mostly in one
 * block, so that adding one is a few operations. octomap's own set hashes every cell. */
class CellSet
{
 public:
  void clear();
  /** \return true if the cell is new */
  bool insert(const octomap::OcTreeKey& key);
  [[nodiscard]] bool contains(const octomap::OcTreeKey& key) const;
  /** Calls `visit(key)` for every cell, block by block in the order in which blocks were met. */
  template <typename Visitor>
  void forEach(const Visitor& visit) const
  {
    for (std::size_t b = 0; b < corners_.size(); ++b)
    {
      for (std::uint32_t i = 0; i < side * side * side; ++i)
      {
        if ((blocks_[b][i / 64] >> (i % 64) & 1U) != 0)
        {
          const octomap::OcTreeKey& c = corners_[b];
          visit(octomap::OcTreeKey(static_cast<octomap::key_type>(c[0] + i / (side * side)),
                                   static_cast<octomap::key_type>(c[1] + i / side % side),
                                   static_cast<octomap::key_type>(c[2] + i % side)));
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t side = 8;
  using Block = std::array<std::uint64_t, side * side * side / 64>;

  static octomap::OcTreeKey cornerOf(const octomap::OcTreeKey& key);
  std::uint32_t blockOf(const octomap::OcTreeKey& key);
  static std::uint32_t bitOf(const octomap::OcTreeKey& key)
  {
    return (key[0] % side * side + key[1] % side) * side + key[2] % side;
  }

  VoxelHash index_;
  std::vector<Block> blocks_;
  std::vector<octomap::OcTreeKey> corners_;  //!< corners of the blocks
  std::uint32_t last_ = VoxelHash::none;     //!< number of the block used last
};
}  // namespace dyslam
