// SPDX-License-Identifier: BSD-3-Clause
#include "GridObstacles.h"

#include <algorithm>
#include <array>

namespace dyslam
{
namespace
{
/** Marks the cells from a to b as occupied, without a diagonal step that a path could cross. */
void markLine(const Eigen::Vector2d& a, const Eigen::Vector2d& b, OccupancyCells& grid)
{
  constexpr double step = 0.1;  // of a cell
  const int steps = std::max(1, static_cast<int>((b - a).norm() / (step * grid.resolution)));
  cv::Point before = grid.cellOf(a.x(), a.y());
  for (int i = 0; i <= steps; ++i)
  {
    const Eigen::Vector2d p = a + (b - a) * (static_cast<double>(i) / steps);
    const cv::Point cell = grid.cellOf(p.x(), p.y());
    grid.set({before.x, cell.y}, OccupancyCells::occupied);
    grid.set(cell, OccupancyCells::occupied);
    before = cell;
  }
}
}  // namespace

ObstacleColumns::ObstacleColumns(const MapPoints& map,
                                 const GridGround& ground,
                                 double side,
                                 std::size_t keyframes,
                                 const MapExportOptions& options)
    : ground_(ground),
      options_(options),
      side_(side),
      // A sensor that never moved has one keyframe, so that all points are of that one.
      needed_(static_cast<std::uint32_t>(
          std::min(static_cast<std::size_t>(options.obstacle_min_hits), keyframes)))
{
  for (std::size_t i = 0; i < map.size(); ++i)
  {
    if (isAtHeight(map.points[i].cast<double>()))
    {
      add(map.points[i], map.hits[i], map.keyframe[i]);
    }
  }
}

Eigen::Vector2i ObstacleColumns::cellOf(const Eigen::Vector3f& p) const
{
  return {cellNumber(static_cast<double>(p.x()) / side_),
          cellNumber(static_cast<double>(p.y()) / side_)};
}

bool ObstacleColumns::isAtHeight(const Eigen::Vector3d& p) const
{
  const double height = ground_.above(p);
  return height >= options_.obstacle_min_height && height <= options_.obstacle_max_height;
}

const ObstacleColumns::Column* ObstacleColumns::find(const Eigen::Vector2i& cell) const
{
  const auto found = index_.find(voxelKey({cell.x(), cell.y(), 0}));
  return found == VoxelHash::none || columns_[found].keyframes < needed_ ? nullptr
                                                                         : &columns_[found];
}

bool ObstacleColumns::isObstacle(const Eigen::Vector3d& p) const
{
  return isAtHeight(p) && find(cellOf(p.cast<float>())) != nullptr;
}

void ObstacleColumns::add(const Eigen::Vector3f& p, std::uint32_t hits, std::uint32_t keyframe)
{
  const Eigen::Vector2i cell = cellOf(p);
  const auto next = static_cast<std::uint32_t>(columns_.size());
  const auto found = index_.findOrInsert(voxelKey({cell.x(), cell.y(), 0}), next);
  if (found == next)
  {
    columns_.emplace_back().cell = cell;
  }
  Column& seen = columns_[found];
  seen.sum += p.head<2>().cast<double>();
  ++seen.points;
  if (std::find(seen.last.begin(), seen.last.end(), keyframe) == seen.last.end())
  {
    seen.last.push_back(keyframe);
  }
  seen.keyframes = std::max({seen.keyframes, hits, static_cast<std::uint32_t>(seen.last.size())});
}

void ObstacleColumns::forEachPair(
    const std::function<void(const Eigen::Vector2d&, const Eigen::Vector2d&)>& use) const
{
  const std::array<Eigen::Vector2i, 4> half_of_neighbours{
      Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 1), Eigen::Vector2i(0, 1), Eigen::Vector2i(1, 1)};
  for (const Column& column : columns_)
  {
    if (column.keyframes < needed_)
    {
      continue;
    }
    for (const Eigen::Vector2i& step : half_of_neighbours)
    {
      const Column* other = find(column.cell + step);
      if (other != nullptr && (other->mean() - column.mean()).norm() <= 2 * side_)
      {
        use(column.mean(), other->mean());
      }
    }
  }
}

void markFineObstacles(const StaticMap& map, const ObstacleColumns& columns, OccupancyCells& grid)
{
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        for (const auto& point : cloud.points)
        {
          const Eigen::Vector3d p = map.poses()[k] * point.cast<double>();
          if (columns.isObstacle(p))
          {
            grid.set(grid.cellOf(p.x(), p.y()), OccupancyCells::occupied);
          }
        }
      });
  columns.forEachPair([&grid](const Eigen::Vector2d& a, const Eigen::Vector2d& b)
                      { markLine(a, b, grid); });
}
}  // namespace dyslam
