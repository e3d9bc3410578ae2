// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Points of one scan ordered by direction: rows are rings, row 0 the lowest; columns are azimuths,
 * column 0 straight behind, rising clockwise seen from above (so that left is left).
 *
 * A cell holds the nearest of its points (ties: the first), or none.
 */
struct RangeImage
{
  static constexpr std::int32_t none = -1;

  int rows = 0;
  int cols = 0;
  std::vector<std::int32_t> index;  //!< row-major: position in the points, or `none`
  std::vector<float> range;         //!< row-major: distance to the sensor [m]; 0 where empty

  [[nodiscard]] std::size_t cell(int row, int col) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) +
           static_cast<std::size_t>(col);
  }
  /** The column, wrapped around the revolution: any `col` in [-cols, 2 cols). */
  [[nodiscard]] int wrapped(int col) const
  {
    return col < 0 ? col + cols : (col >= cols ? col - cols : col);
  }
};

/** Column of a point in an image of `cols` columns. */
[[nodiscard]] int azimuthColumn(const Eigen::Vector3f& p, int cols);
/** Angle over the sensor's xy plane [rad]. */
[[nodiscard]] float elevationOf(const Eigen::Vector3f& p);

/** Rows from the ring numbers; points that are no returns or whose ring is >= rows are left out. */
[[nodiscard]] RangeImage projectByRing(const std::vector<Eigen::Vector3f>& points,
                                       const std::vector<std::uint16_t>& rings,
                                       int rows,
                                       int cols);

/** Ring of each point where a recording has none, 0 the lowest; empty if they cannot be found.
 *
 * Files that store one ring after the other (as KITTI's) show it by the azimuth, which jumps back
 * once a ring; where that gives no sensible number of rings, elevations are clustered. Points that
 * are no returns get the ring of the point before.
 */
[[nodiscard]] std::vector<std::uint16_t> estimateRings(const std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
