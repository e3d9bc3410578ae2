// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/BevScan.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** The occupied cells of a square grid, in ascending order of their indices y * width + x. */
struct CellLevel
{
  int width = 0;
  std::vector<std::int32_t> number;  //!< index of each occupied cell
  std::vector<std::int32_t>
      row_of_cell;  //!< width^2: row (position in `number`) of each cell, -1 if empty
  std::vector<std::int32_t> row_of_point;  //!< row of each point's cell

  [[nodiscard]] std::size_t size() const { return number.size(); }
};

/** The occupied cells of a scan at full, 1/2, 1/4 and 1/8 resolution. */
struct CellPyramid
{
  explicit CellPyramid(const BevScan& scan);

  CellLevel full;
  CellLevel half;
  CellLevel quarter;
  CellLevel eighth;
};

/** Row indices for a 3 x 3 convolution: for each cell of `out` the rows of the 3 x 3 cells of `in`
 * under the kernel, y slow, -1 for empty ones. Stride 1 with the same level twice; stride 2 with
 * `in` twice as fine as `out`. */
[[nodiscard]] std::vector<std::int32_t> convolutionRows(const CellLevel& in, const CellLevel& out);

/** For each cell of `out` the rows of its four children in `in`, which is twice as fine. */
[[nodiscard]] std::vector<std::int32_t> childRows(const CellLevel& in, const CellLevel& out);

/** For each cell of `in` the row of its parent in `out`, which is half as fine. */
[[nodiscard]] std::vector<std::int32_t> parentRows(const CellLevel& in, const CellLevel& out);

/** Centres of a level's cells, in the frame of the scan's points [m]. */
[[nodiscard]] std::vector<Eigen::Vector2f> cellCentres(const CellLevel& level, const BevScan& scan);
}  // namespace dyslam
