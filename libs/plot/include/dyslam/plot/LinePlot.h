// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** One line of a plot: points (x, y) in the order in which they are joined. */
struct LineSeries
{
  std::string name;
  std::vector<Eigen::Vector2d> points;
};

struct LinePlotOptions
{
  std::string title;
  std::string x_label;
  std::string y_label;
  double low = 0;  //!< lowest value of the y axis
  double quantile =
      1;  //!< quantile of the y values that the axis must reach; below 1 single peaks are cut off
};

/** PNG of lines over one pair of axes, with a legend. The first series is drawn first.
 * \throws std::invalid_argument without points. */
[[nodiscard]] std::vector<std::uint8_t> renderLinePlot(const std::vector<LineSeries>& series,
                                                       const LinePlotOptions& options = {});
}  // namespace dyslam
