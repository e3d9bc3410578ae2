// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/mapping/StaticMap.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "GridGround.h"
#include "OccupancyCells.h"

namespace dyslam
{
/** Columns of voxels with a return at the height of obstacles, and the number of keyframes with
 * such a return: a lower bound, since the map stores for each voxel the number of keyframes that
 * hit it, but only the last one of them. */
class ObstacleColumns
{
 public:
  /** \param side side of the columns [m] \param keyframes number of keyframes of the map */
  ObstacleColumns(const MapPoints& map,
                  const GridGround& ground,
                  double side,
                  std::size_t keyframes,
                  const MapExportOptions& options);

  /** Whether a point is at the height of obstacles, in a column that enough keyframes observed. */
  [[nodiscard]] bool isObstacle(const Eigen::Vector3d& p) const;

  /** Calls `use` with the mean places of every two obstacles' columns that lie side by side, also
   * diagonally, where the places are at most two columns apart. */
  void forEachPair(
      const std::function<void(const Eigen::Vector2d&, const Eigen::Vector2d&)>& use) const;

 private:
  struct Column
  {
    Eigen::Vector2i cell = Eigen::Vector2i::Zero();
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();  // sum of its points at obstacle height [m]
    std::uint32_t points = 0;
    std::uint32_t keyframes = 0;
    std::vector<std::uint32_t> last;  // last keyframes that hit its voxels

    [[nodiscard]] Eigen::Vector2d mean() const { return sum / points; }
  };

  [[nodiscard]] Eigen::Vector2i cellOf(const Eigen::Vector3f& p) const;
  [[nodiscard]] bool isAtHeight(const Eigen::Vector3d& p) const;
  /** Column of a point; null unless enough keyframes observed an obstacle there. */
  [[nodiscard]] const Column* find(const Eigen::Vector2i& cell) const;
  void add(const Eigen::Vector3f& p, std::uint32_t hits, std::uint32_t keyframe);

  const GridGround& ground_;
  MapExportOptions options_;
  double side_;
  std::uint32_t needed_;
  VoxelHash index_;
  std::vector<Column> columns_;
};

/** Marks obstacles in a grid that is finer than the map's voxels, whose points alone would leave
 * gaps: every point of the keyframes, and the lines between neighbouring columns. A gap remains
 * where a column without an obstacle lies between. */
void markFineObstacles(const StaticMap& map, const ObstacleColumns& columns, OccupancyCells& grid);
}  // namespace dyslam
