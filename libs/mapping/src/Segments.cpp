// SPDX-License-Identifier: BSD-3-Clause
#include "Segments.h"

#include <dyslam/base/DisjointSets.h>

#include <algorithm>

namespace dyslam
{
namespace
{
/** Fills in `neighbours`; each pair of touching cells is found once. */
void findNeighbours(Segments& segments)
{
  constexpr std::uint32_t middle = 13;  // index of the cell itself among the 27
  std::array<std::uint32_t, 27> nobody{};
  nobody.fill(Segments::none);
  segments.neighbours.assign(segments.cells.size(), nobody);
  for (std::uint32_t i = 0; i < segments.cells.size(); ++i)
  {
    const VoxelCell& c = segments.cells[i];
    segments.neighbours[i][middle] = i;
    for (int n = 0; n < static_cast<int>(middle); ++n)
    {
      const std::uint32_t found = segments.cell_index.find(
          voxelKey({c.x + n / 9 - 1, c.y + n / 3 % 3 - 1, c.z + n % 3 - 1}));
      if (found != Segments::none)
      {
        segments.neighbours[i][static_cast<std::size_t>(n)] = found;
        segments.neighbours[found][static_cast<std::size_t>(26 - n)] = i;
      }
    }
  }
}

/** Connected components of touching cells. */
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
  result.voxel_of_point.assign(points.size(), Segments::none);
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
    const std::uint64_t key = voxelKey(voxelCell(points[i], inverse_voxel));
    const std::uint32_t voxel = voxel_index.findOrInsert(key, next);
    result.voxel_of_point[i] = voxel;
    if (voxel == next)
    {
      result.first_point.push_back(i);
      result.key_of_voxel.push_back(key);
      const VoxelCell cell = voxelCell(points[i], result.inverse_cell_size);
      const auto next_cell = static_cast<std::uint32_t>(result.cells.size());
      result.cell_of_voxel.push_back(result.cell_index.findOrInsert(voxelKey(cell), next_cell));
      if (result.cell_of_voxel.back() == next_cell)
      {
        result.cells.push_back(cell);
      }
    }
  }
  findNeighbours(result);
  DisjointSets sets = joined(result);
  std::vector<std::uint32_t> number(result.cells.size(), Segments::none);
  for (const std::uint32_t cell : result.cell_of_voxel)
  {
    std::uint32_t& n = number[sets.find(cell)];
    n = n == Segments::none ? static_cast<std::uint32_t>(result.segments++) : n;
    result.segment_of_voxel.push_back(n);
  }
  return result;
}
}  // namespace dyslam
