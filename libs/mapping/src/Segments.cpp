// SPDX-License-Identifier: BSD-3-Clause
#include "Segments.h"

#include <dyslam/core/DisjointSets.h>

#include <algorithm>

namespace dyslam
{
namespace
{
/** Joins the cells that touch. */
DisjointSets joined(const Segments& segments)
{
  DisjointSets sets(segments.cells.size());
  for (std::uint32_t i = 0; i < segments.cells.size(); ++i)
  {
    segments.forEachNeighbour(i, [&](std::uint32_t n) { sets.join(i, n); });
  }
  return sets;
}
}  // namespace

Segments findSegments(const std::vector<Eigen::Vector3f>& points,
                      const std::vector<bool>& use,
                      double voxel_size,
                      double cell_size)
{
  Segments result;
  result.group_of_point.assign(points.size(), Segments::none);
  VoxelHash voxel_index;
  const auto inverse_voxel = static_cast<float>(1.0 / voxel_size);
  result.inverse_cell_size = static_cast<float>(1.0 / cell_size);
  for (std::uint32_t i = 0; i < points.size(); ++i)
  {
    if (!use[i])
    {
      continue;
    }
    const auto next = static_cast<std::uint32_t>(result.first_point.size());
    const std::uint32_t group =
        voxel_index.findOrInsert(voxelKey(voxelCell(points[i], inverse_voxel)), next);
    result.group_of_point[i] = group;
    if (group == next)
    {
      result.first_point.push_back(i);
      const VoxelCell cell = voxelCell(points[i], result.inverse_cell_size);
      const auto next_cell = static_cast<std::uint32_t>(result.cells.size());
      result.cell_of_group.push_back(result.cell_index.findOrInsert(voxelKey(cell), next_cell));
      if (result.cell_of_group.back() == next_cell)
      {
        result.cells.push_back(cell);
      }
    }
  }
  DisjointSets sets = joined(result);
  std::vector<std::uint32_t> number(result.cells.size(), Segments::none);
  for (const std::uint32_t cell : result.cell_of_group)
  {
    std::uint32_t& n = number[sets.find(cell)];
    n = n == Segments::none ? static_cast<std::uint32_t>(result.segments++) : n;
    result.segment_of_group.push_back(n);
  }
  return result;
}
}  // namespace dyslam
