// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Ceilings.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace dyslam
{
namespace
{
constexpr double least_height = 2.2;  // [m]
constexpr double cell_side = 1;       // [m]
constexpr double column_side = 0.4;   // [m]
constexpr double layer_height = 0.2;  // [m]
constexpr double highest = 12.7;      // of ceilings [m]
constexpr std::size_t layers = 64;
constexpr double least_share = 0.6;
constexpr double least_share_of_map = 0.005;
constexpr int least_cells = 6;  // more than a wall has, also one across

using LayerCounts = std::array<std::uint32_t, layers>;

VoxelCell cellOf(const Eigen::Vector3f& p, double side)
{
  return {cellNumber(static_cast<double>(p.x()) / side),
          cellNumber(static_cast<double>(p.y()) / side), 0};
}

std::size_t layerOf(double height)
{
  return static_cast<std::size_t>(std::clamp(height, 0.0, highest) / layer_height);
}

std::uint64_t bitOf(std::size_t layer)
{
  return std::uint64_t{1} << layer;
}

/** Points in a layer and those above and below it. */
std::uint64_t near(const LayerCounts& counts, std::size_t layer)
{
  std::uint64_t sum = counts[layer];
  sum += layer > 0 ? counts[layer - 1] : 0;
  sum += layer + 1 < layers ? counts[layer + 1] : 0;
  return sum;
}

/** Layers of a cell that are ceilings. \param around counts of the cell and those around it */
std::uint64_t ceilingLayers(const LayerCounts& counts,
                            const std::vector<const LayerCounts*>& around)
{
  std::uint64_t all = 0;
  for (const LayerCounts* cell : around)
  {
    for (const std::uint32_t count : *cell)
    {
      all += count;
    }
  }
  std::uint64_t result = 0;
  for (std::size_t layer = 0; layer < layers; ++layer)
  {
    if (counts[layer] == 0)
    {
      continue;
    }
    std::uint64_t at_height = 0;
    int cells_at_height = 0;
    for (const LayerCounts* cell : around)
    {
      const std::uint64_t of_cell = near(*cell, layer);
      at_height += of_cell;
      cells_at_height += of_cell > 0 ? 1 : 0;
    }
    if (cells_at_height >= least_cells &&
        static_cast<double>(at_height) > least_share * static_cast<double>(all))
    {
      result |= bitOf(layer);
    }
  }
  return result;
}
}  // namespace

Ceilings::Ceilings(const std::vector<Eigen::Vector3f>& points, const MapGround& ground)
{
  std::vector<VoxelCell> cells;
  std::vector<LayerCounts> counts;
  for (const auto& p : points)
  {
    const double height = p.allFinite() ? ground.heightOver(p) : 0;
    if (height > least_height)
    {
      const VoxelCell place = cellOf(p, cell_side);
      const auto new_cell = static_cast<std::uint32_t>(cells.size());
      const std::uint32_t cell = cells_.findOrInsert(voxelKey(place), new_cell);
      if (cell == new_cell)
      {
        cells.push_back(place);
        counts.push_back({});
      }
      ++counts[cell][layerOf(height)];
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    std::vector<const LayerCounts*> around;
    for (int k = 0; k < 9; ++k)
    {
      const VoxelCell other{cells[i].x + k / 3 - 1, cells[i].y + k % 3 - 1, 0};
      const std::uint32_t found = cells_.find(voxelKey(other));
      if (found != VoxelHash::none)
      {
        around.push_back(&counts[found]);
      }
    }
    ceiling_layers_.push_back(ceilingLayers(counts[i], around));
  }
  addColumns(points, ground);
}

void Ceilings::addColumns(const std::vector<Eigen::Vector3f>& points, const MapGround& ground)
{
  for (const auto& p : points)
  {
    if (p.allFinite() && (ceilingLayersAt(p) & bitOf(layerOf(ground.heightOver(p)))) != 0)
    {
      const auto new_column = static_cast<std::uint32_t>(columns_.size());
      (void)columns_.findOrInsert(voxelKey(cellOf(p, column_side)), new_column);
    }
  }
  column_layers_.resize(columns_.size());
  for (const auto& p : points)
  {
    const std::uint32_t column =
        p.allFinite() ? columns_.find(voxelKey(cellOf(p, column_side))) : VoxelHash::none;
    if (column != VoxelHash::none)
    {
      column_layers_[column] |= bitOf(layerOf(ground.heightOver(p)));
    }
  }
}

std::uint64_t Ceilings::ceilingLayersAt(const Eigen::Vector3f& p) const
{
  const std::uint32_t cell = cells_.find(voxelKey(cellOf(p, cell_side)));
  return cell == VoxelHash::none ? 0 : ceiling_layers_[cell];
}

bool Ceilings::contain(const Eigen::Vector3f& p, double height) const
{
  if (height <= least_height || height >= highest)
  {
    return false;
  }
  const std::size_t layer = layerOf(height);
  if ((ceilingLayersAt(p) & bitOf(layer)) == 0)
  {
    return false;
  }
  const std::uint32_t column = columns_.find(voxelKey(cellOf(p, column_side)));
  const std::uint64_t right_below = bitOf(layer - 2) | bitOf(layer - 3) | bitOf(layer - 4);
  return column != VoxelHash::none && (column_layers_[column] & right_below) == 0;
}

std::vector<bool> ceilingPoints(const std::vector<Eigen::Vector3f>& points)
{
  const MapGround ground(points);
  const Ceilings ceilings(points, ground);
  std::vector<bool> result(points.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto& p = points[i];
    result[i] = p.allFinite() && ceilings.contain(p, ground.heightOver(p));
    count += result[i] ? 1 : 0;
  }
  if (static_cast<double>(count) < least_share_of_map * static_cast<double>(points.size()))
  {
    result.assign(points.size(), false);
  }
  return result;
}
}  // namespace dyslam
