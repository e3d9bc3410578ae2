// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

namespace dyslam
{
/** Cells of an occupancy grid; cell (0, 0) has its lower left corner at the origin. */
struct OccupancyCells
{
  // What ROS' map_server reads with negate 0: dark is occupied, bright is free.
  static constexpr std::uint8_t occupied = 0;
  static constexpr std::uint8_t free_space = 254;
  static constexpr std::uint8_t unknown = 205;

  double resolution = 0.1;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  cv::Mat cells;  // row 0 is the highest y, as pictures have it

  /** Number of a column (axis 0), or of a row from the lowest (axis 1). */
  [[nodiscard]] double numberOf(double value, int axis) const
  {
    return std::floor((value - origin[axis]) / resolution);
  }
  [[nodiscard]] cv::Point cellOf(double x, double y) const
  {
    return {static_cast<int>(numberOf(x, 0)), cells.rows - 1 - static_cast<int>(numberOf(y, 1))};
  }
  [[nodiscard]] bool has(const cv::Point& c) const
  {
    return c.x >= 0 && c.y >= 0 && c.x < cells.cols && c.y < cells.rows;
  }
  /** Sets a cell, if the grid has it. */
  void set(const cv::Point& c, std::uint8_t value)
  {
    if (has(c))
    {
      cells.at<std::uint8_t>(c) = value;
    }
  }
};
}  // namespace dyslam
