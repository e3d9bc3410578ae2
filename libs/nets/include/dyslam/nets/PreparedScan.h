// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Range image and sampling pyramid of a scan, the input of DyLO's network.
 *
 * Rows are beams (row 0 the lowest), columns azimuths (column 0 straight behind, clockwise seen
 * from above). The nodes of coarser levels form grids over the same directions, so that neighbours
 * are searched in image windows.
 */
struct PreparedScan
{
  static constexpr int columns = 1800;
  static constexpr int max_rows = 64;
  static constexpr int slope_bins = 2048;  //!< size of `row_of_slope`, over slopes in [-1, 1)
  static constexpr std::size_t level_count = 5;

  struct Level
  {
    int rows = 0;
    int cols = 0;
    std::vector<std::int32_t> cell;  //!< row-major: image cell of each node, -1 if empty

    [[nodiscard]] std::size_t size() const { return cell.size(); }
  };

  int rows = 0;
  std::vector<Eigen::Vector3f> points;  //!< point of each image cell, row-major; zero if empty [m]
  std::vector<std::int32_t> source;     //!< index of each cell's point in the cloud, -1 if empty
  std::vector<std::int32_t>
      cell_of_point;  //!< image cell of each point of the cloud, -1 if not used
  std::vector<std::int32_t> row_of_slope;  //!< image row of each bin of slope z / hypot(x, y)
  std::array<Level, level_count> levels;   //!< 8192, 2048, 1024, 256 and 64 nodes
  std::vector<std::int32_t>
      first_level_of;  //!< concatenated levels 2 to 4: node of level 1, -1 if empty
  std::vector<Eigen::Vector3f> normals;  //!< level 1, towards the sensor; zero if unknown
  std::vector<float> planarity;          //!< planarity of level 1, in [0, 1]
  std::size_t valid_points = 0;          //!< number of occupied image cells

  [[nodiscard]] bool empty() const { return valid_points == 0; }
};

/** \param points sensor frame, x forward, z up [m]; points that are not finite, nearer than
 * 1.5 m or farther than 100 m are ignored. Linear in the number of points. */
[[nodiscard]] PreparedScan prepareScan(const std::vector<Eigen::Vector3f>& points);

/** Image column of a direction. */
[[nodiscard]] int imageColumn(float x, float y, int cols);
/** Bin of a slope z / hypot(x, y), an index into row_of_slope. */
[[nodiscard]] int slopeBin(float slope);
}  // namespace dyslam
