// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam::sim
{
/** Axis-parallel rectangle [m]. */
struct Rect
{
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();

  [[nodiscard]] Eigen::Vector2d centre() const { return 0.5 * (low + high); }
  [[nodiscard]] Eigen::Vector2d size() const { return high - low; }
  [[nodiscard]] Rect grown(double by) const
  {
    return {low - Eigen::Vector2d(by, by), high + Eigen::Vector2d(by, by)};
  }
  [[nodiscard]] bool overlaps(const Rect& o) const
  {
    return low.x() < o.high.x() && o.low.x() < high.x() && low.y() < o.high.y() &&
           o.low.y() < high.y();
  }
};

/** The floor of a building as a grid: where people can walk, and how far the next wall or piece of
 * furniture is. World coordinates. */
class FloorPlan
{
 public:
  FloorPlan() = default;
  /** A plan without free floor. \param extent of the grid \param cell its cell size [m] */
  FloorPlan(const Rect& extent, double cell);

  [[nodiscard]] bool empty() const { return cells_.empty(); }
  /** The floor of a room. */
  void free(const Rect& room);
  /** What stands on the floor. */
  void block(const Rect& footprint);
  /** Floor that furniture must leave free: all within `half_width` of a straight way [m]. */
  void reserve(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double half_width);
  /** Whether furniture can stand there: all is free floor and not reserved. */
  [[nodiscard]] bool available(const Rect& footprint) const;

  /** To be called when everything is in place, before clearance() and away(). */
  void measureClearance();
  /** Distance to the nearest wall or piece of furniture, at most 2.5 [m]; 0 off the floor. To
   * about a cell, and up to 8 % too long, as an octagon is for a circle. */
  [[nodiscard]] double clearance(const Eigen::Vector2d& p) const;
  /** Unit vector away from the nearest wall or piece of furniture; zero far from any. */
  [[nodiscard]] Eigen::Vector2d away(const Eigen::Vector2d& p) const;
  /** Whether all of a straight way is at least this far from walls and furniture [m]. */
  [[nodiscard]] bool isClear(const Eigen::Vector2d& a,
                             const Eigen::Vector2d& b,
                             double distance) const;

 private:
  /** Cells of a rectangle, [low, high) in x and y. */
  struct CellRange
  {
    int x0, y0, x1, y1;
  };
  [[nodiscard]] CellRange cellsOf(const Rect& r) const;
  [[nodiscard]] std::size_t at(int x, int y) const
  {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] double clearanceOfCell(int x, int y) const;

  Rect extent_;
  double cell_ = 0.1;
  int nx_ = 0, ny_ = 0;
  std::vector<std::uint8_t> cells_;  // 0: no floor, 1: free, 2: free and reserved
  std::vector<float> clearance_;     // [m]
};
}  // namespace dyslam::sim
