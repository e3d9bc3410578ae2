// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/plot/LinePlot.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "PlotPage.h"

namespace dyslam
{
std::vector<std::uint8_t> renderLinePlot(const std::vector<LineSeries>& series,
                                         const LinePlotOptions& options)
{
  using namespace plot;
  Range x;
  std::vector<double> values;
  for (const LineSeries& line : series)
  {
    for (const Eigen::Vector2d& point : line.points)
    {
      x.add(point.x());
      values.push_back(point.y());
    }
  }
  if (values.empty())
  {
    throw std::invalid_argument("renderLinePlot: nothing to draw");
  }
  if (!(x.size() > 0))
  {
    x = {x.low - 1, x.high + 1};
  }
  const double highest = quantile(values, std::clamp(options.quantile, 0.0, 1.0));
  const double top = std::max(highest, options.low + 1e-6);
  const Range y{options.low, options.low + 1.1 * (top - options.low)};

  constexpr int width = 1000 * supersampling;
  constexpr int height = 380 * supersampling;
  const int footer = (24 * static_cast<int>(series.size()) + 24) * supersampling;
  cv::Mat page(height + footer, width, CV_8UC3, white);
  Panel panel(page,
              {90 * supersampling, 50 * supersampling, width - 120 * supersampling,
               height - 110 * supersampling},
              x, y);
  panel.drawAxes(options.title, options.x_label, options.y_label);
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < series.size(); ++i)
  {
    curves.push_back({series[i].name, series[i].points, curveColour(i)});
    if (!series[i].points.empty())
    {
      panel.drawCurve(curves.back());
    }
  }
  drawLegend(page, {90 * supersampling, height + 12 * supersampling}, curves);
  return encodePage(page);
}
}  // namespace dyslam
