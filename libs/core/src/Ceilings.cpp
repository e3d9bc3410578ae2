// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Ceilings.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dyslam
{
namespace
{
constexpr double least_height = 2.2;  // of ceilings over the ground [m]
constexpr double highest = 12.7;      // of ceilings over the ground [m]
constexpr double cell_side = 1;       // [m]
constexpr double column_side = 0.4;   // [m]
constexpr double layer_height = 0.2;  // [m]
constexpr std::size_t layers = 64;    // as many as there are between ground and `highest`
constexpr double least_share = 0.6;
constexpr int least_cells = 6;  // more than a wall has, also one across
constexpr double least_share_of_map = 0.005;

using LayerCounts = std::array<std::uint32_t, layers>;

VoxelCell cellOf(const Eigen::Vector3f& p, double side)
{
  return {cellNumber(static_cast<double>(p.x()) / side),
          cellNumber(static_cast<double>(p.y()) / side), 0};
}

std::uint64_t keyOf(const Eigen::Vector3f& p, double side)
{
  return voxelKey(cellOf(p, side));
}

/** Layer of a point, by its height in the map: the ground below it may be known badly. After the
 * last layer the first one follows. */
std::size_t layerOf(const Eigen::Vector3f& p)
{
  const std::int32_t number = cellNumber(static_cast<double>(p.z()) / layer_height);
  return static_cast<std::size_t>(static_cast<std::uint32_t>(number)) % layers;
}

std::size_t below(std::size_t layer, std::size_t by)
{
  return (layer + layers - by) % layers;
}

std::uint64_t bitOf(std::size_t layer)
{
  return std::uint64_t{1} << layer;
}

/** Layers of a cell that are ceilings, a bit each. \param around counts of the cell and of those
 * around it */
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
      const std::uint64_t of_cell =
          std::uint64_t{(*cell)[below(layer, 1)]} + (*cell)[layer] + (*cell)[(layer + 1) % layers];
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

/** Points overhead, in cells of 1 m by layer. */
class OverheadLayers
{
 public:
  void add(const Eigen::Vector3f& p)
  {
    const auto next = static_cast<std::uint32_t>(cells_.size());
    const std::uint32_t cell = places_.findOrInsert(keyOf(p, cell_side), next);
    if (cell == next)
    {
      cells_.push_back(cellOf(p, cell_side));
      counts_.emplace_back();
    }
    ++counts_[cell][layerOf(p)];
  }

  /** Decides which layers are ceilings; after the last point. */
  void decide()
  {
    for (std::size_t i = 0; i < cells_.size(); ++i)
    {
      std::vector<const LayerCounts*> around;
      for (int k = 0; k < 9; ++k)
      {
        const VoxelCell beside{cells_[i].x + k / 3 - 1, cells_[i].y + k % 3 - 1, 0};
        const std::uint32_t found = places_.find(voxelKey(beside));
        if (found != VoxelHash::none)
        {
          around.push_back(&counts_[found]);
        }
      }
      ceilings_.push_back(ceilingLayers(counts_[i], around));
    }
  }

  /** Whether the layer of a point is a ceiling. \pre decide() */
  [[nodiscard]] bool isCeiling(const Eigen::Vector3f& p) const
  {
    const std::uint32_t cell = places_.find(keyOf(p, cell_side));
    return cell != VoxelHash::none && (ceilings_[cell] & bitOf(layerOf(p))) != 0;
  }

 private:
  VoxelHash places_;  //!< of cells in the vectors
  std::vector<VoxelCell> cells_;
  std::vector<LayerCounts> counts_;      //!< numbers of points
  std::vector<std::uint64_t> ceilings_;  //!< layers that are ceilings, a bit each
};

/** Takes those off that have points right below them in the same column of 0.4 m. */
void leaveOutSides(const std::vector<Eigen::Vector3f>& points,
                   const MapGround& ground,
                   std::vector<bool>& is_ceiling)
{
  VoxelHash columns;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (is_ceiling[i])
    {
      (void)columns.findOrInsert(keyOf(points[i], column_side),
                                 static_cast<std::uint32_t>(columns.size()));
    }
  }
  std::vector<std::uint64_t> occupied(columns.size());  // layers, a bit each
  for (const auto& p : points)
  {
    const std::uint32_t column =
        p.allFinite() ? columns.find(keyOf(p, column_side)) : VoxelHash::none;
    if (column != VoxelHash::none && ground.heightOverLowest(p) < highest)
    {
      occupied[column] |= bitOf(layerOf(p));
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (is_ceiling[i])
    {
      const std::size_t layer = layerOf(points[i]);
      const std::uint64_t right_below =
          bitOf(below(layer, 2)) | bitOf(below(layer, 3)) | bitOf(below(layer, 4));
      is_ceiling[i] = (occupied[columns.find(keyOf(points[i], column_side))] & right_below) == 0;
    }
  }
}
}  // namespace

std::vector<bool> ceilingPoints(const std::vector<Eigen::Vector3f>& points, const MapGround& ground)
{
  const auto isOverhead = [&](const Eigen::Vector3f& p)
  {
    const double height = p.allFinite() ? ground.heightOverLowest(p) : 0;
    return height > least_height && height < highest;
  };
  OverheadLayers overhead;
  for (const auto& p : points)
  {
    if (isOverhead(p))
    {
      overhead.add(p);
    }
  }
  overhead.decide();
  std::vector<bool> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    result[i] = isOverhead(points[i]) && overhead.isCeiling(points[i]);
  }
  leaveOutSides(points, ground, result);
  return result;
}

std::vector<bool> ceilingPointsIfMany(const std::vector<Eigen::Vector3f>& points)
{
  std::vector<bool> result = ceilingPoints(points, MapGround(points));
  const auto count = std::count(result.begin(), result.end(), true);
  if (static_cast<double>(count) < least_share_of_map * static_cast<double>(points.size()))
  {
    result.assign(points.size(), false);
  }
  return result;
}
}  // namespace dyslam
