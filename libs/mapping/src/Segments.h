// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** The points of a scan in voxels, and the voxels clustered to segments (connected components of
 * touching cells). Voxels are numbered in the order of their first points. */
struct Segments
{
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  std::vector<std::uint32_t> voxel_of_point;  //!< voxel of each point, or none
  std::vector<std::uint32_t> first_point;     //!< first point of each voxel
  std::vector<std::uint64_t> key_of_voxel;    //!< voxelKey() of each voxel
  std::vector<std::uint32_t>
      segment_of_voxel;          //!< segments are numbered in order of their first points
  std::size_t segments = 0;      //!< number of segments
  std::vector<VoxelCell> cells;  //!< cells that hold voxels
  std::vector<std::uint32_t> cell_of_voxel;
  VoxelHash cell_index;         //!< from voxelKey() to position in `cells`
  float inverse_cell_size = 1;  //!< [1/m]

  /** The cells that touch each cell, and the cell itself; `none` where there is no such cell. */
  std::vector<std::array<std::uint32_t, 27>> neighbours;

  /** Calls `use` with the index of the cell and of each cell that touches it. */
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

/** Clusters points. \param points odometry frame [m] \param use which points are clustered; the
 * others get no voxel \param voxel_size side of the voxels [m] \param cell_size side of the cells,
 * each of which touches 26 others [m].
 */
[[nodiscard]] Segments findSegments(const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<bool>& use,
                                    double voxel_size,
                                    double cell_size);
}  // namespace dyslam
