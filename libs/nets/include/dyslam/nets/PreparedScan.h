// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** A scan laid out for the networks: points ordered by where the sensor looked.
 *
 * Rows are beams (row 0 the lowest), columns azimuths (column 0 straight behind, clockwise seen
 * from above). Coarser levels are grids over the same directions, so that a neighbour search is a
 * window.
 */
struct PreparedScan
{
  static constexpr int columns = 1800;
  static constexpr int max_rows = 64;
  static constexpr int slope_bins = 2048;  //!< of `row_of_slope`, over slopes in [-1, 1)
  static constexpr std::size_t level_count = 5;

  struct Level
  {
    int rows = 0;
    int cols = 0;
    std::vector<std::int32_t> cell;  //!< row-major: the image cell of each node, -1 if it is empty

    [[nodiscard]] std::size_t size() const { return cell.size(); }
  };

  int rows = 0;
  std::vector<Eigen::Vector3f> points;      //!< of each image cell, row-major; zero where empty [m]
  std::vector<std::int32_t> source;         //!< position in the cloud, -1 where empty
  std::vector<std::int32_t> cell_of_point;  //!< of each point of the cloud, -1 if it is left out
  std::vector<std::int32_t> row_of_slope;   //!< image row by slope z/hypot(x,y)
  std::array<Level, level_count> levels;    //!< 8192, 2048, 1024, 256 and 64 nodes
  std::vector<std::int32_t>
      first_level_of;                    //!< per level 2..4 in turn: node of level 1, -1 if empty
  std::vector<Eigen::Vector3f> normals;  //!< of level 1, towards the sensor; zero where unknown
  std::vector<float> planarity;          //!< of level 1, 0 no plane .. 1 a plane
  std::size_t valid_points = 0;          //!< occupied image cells

  [[nodiscard]] bool empty() const { return valid_points == 0; }
};

/** \param points sensor at the origin, z up, x forward [m]; points that are not finite, nearer than
 * 1.5 m or farther than 100 m are left out. Linear in the number of points. */
[[nodiscard]] PreparedScan prepareScan(const std::vector<Eigen::Vector3f>& points);

/** Column of a direction, as the networks compute it. */
[[nodiscard]] int imageColumn(float x, float y, int cols);
/** Image row of a slope z/hypot(x,y). */
[[nodiscard]] int slopeBin(float slope);
}  // namespace dyslam
