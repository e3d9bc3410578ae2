// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/BevScan.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** The occupied cells of a square grid, in ascending order of their numbers y * width + x. */
struct CellLevel
{
  int width = 0;
  std::vector<std::int32_t> number;        //!< of each occupied cell
  std::vector<std::int32_t> row_of_cell;   //!< width^2: position in `number`, -1 if empty
  std::vector<std::int32_t> row_of_point;  //!< of the cell of each kept point

  [[nodiscard]] std::size_t size() const { return number.size(); }
};

/** The occupied cells of a scan at full, 1/2, 1/4 and 1/8 resolution. */
struct CellLevels
{
  explicit CellLevels(const BevScan& scan);

  CellLevel full;
  CellLevel half;
  CellLevel quarter;
  CellLevel eighth;
};

/** For each cell of `out` the rows of the 3 x 3 cells of `in` under it, -1 where there is none:
 * 9 per cell, y slow. The same level twice gives the neighbours; `in` twice as fine as `out` gives
 * what a convolution of stride 2 reads. */
[[nodiscard]] std::vector<std::int32_t> convolutionRows(const CellLevel& in, const CellLevel& out);

/** For each cell of `out` the rows of the four cells of `in`, twice as fine, that make it up. */
[[nodiscard]] std::vector<std::int32_t> childRows(const CellLevel& in, const CellLevel& out);

/** For each cell of `in` the row of the cell of `out`, half as fine, that it is part of. */
[[nodiscard]] std::vector<std::int32_t> parentRows(const CellLevel& in, const CellLevel& out);

/** Centres of a level's cells, in the frame of the scan's points [m]. */
[[nodiscard]] std::vector<Eigen::Vector2f> cellCentres(const CellLevel& level, const BevScan& scan);
}  // namespace dyslam
