// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Points joined to groups (one voxel each) and groups to segments (neighbouring cells). */
struct Segments
{
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  std::vector<std::uint32_t> group_of_point;    //!< or none
  std::vector<std::uint32_t> first_point;       //!< of each group
  std::vector<std::uint64_t> voxel_of_group;    //!< its voxelKey()
  std::vector<std::uint32_t> segment_of_group;  //!< numbered in order of their first points
  std::size_t segments = 0;
  std::vector<VoxelCell> cells;  //!< that hold groups
  std::vector<std::uint32_t> cell_of_group;
  VoxelHash cell_index;         //!< from voxelKey() to position in `cells`
  float inverse_cell_size = 1;  //!< [1/m]

  /** The cells that touch each cell, and the cell itself; `none` where there is no such cell. */
  std::vector<std::array<std::uint32_t, 27>> neighbours;

  /** Calls `use` with the cell and the cells that touch it. */
  template <typename Use>
  void forEachNeighbour(std::uint32_t cell, const Use& use) const
  {
    for (const std::uint32_t n : neighbours[cell])
    {
      if (n != none)
      {
        use(n);
      }
    }
  }
};

/** \param points to be joined \param use which of them; the others get no group
 * \param voxel_size of a group \param cell_size of the cells whose 26 neighbours touch [m]. */
[[nodiscard]] Segments findSegments(const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<bool>& use,
                                    double voxel_size,
                                    double cell_size);
}  // namespace dyslam
