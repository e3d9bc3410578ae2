// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/plot/LearningCurves.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "PlotPage.h"

namespace dyslam
{
namespace
{
using namespace plot;

constexpr int panels_across = 3;
constexpr int panel_width = 640 * supersampling;
constexpr int panel_height = 360 * supersampling;
constexpr std::size_t max_unsmoothed_rows = 60;
constexpr std::size_t windows_per_curve = 50;

/** Whether a value is finite and small enough that the difference of two such values is finite. */
bool isDrawable(double value)
{
  constexpr double largest = 1e150;
  return std::abs(value) < largest;
}

Curve runningMean(const Curve& raw)
{
  Curve curve = raw;
  const std::size_t half = std::max<std::size_t>(1, raw.points.size() / (2 * windows_per_curve));
  for (std::size_t i = 0; i < raw.points.size(); ++i)
  {
    const std::size_t from = i < half ? 0 : i - half;
    const std::size_t to = std::min(raw.points.size(), i + half + 1);
    double sum = 0;
    for (std::size_t k = from; k < to; ++k)
    {
      sum += raw.points[k].y();
    }
    curve.points[i].y() = sum / static_cast<double>(to - from);
  }
  return curve;
}

/** Range between the 1 % and 99 % quantiles: robust against outliers. */
Range robustRange(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() > max_unsmoothed_rows ? values.size() / 100 : 0;
  Range range;
  range.add(values[cut]);
  range.add(values[values.size() - 1 - cut]);
  const double margin = range.size() > 0 ? 0.06 * range.size() : 1;
  return {range.low - margin, range.high + margin};
}

void drawPanel(cv::Mat& page,
               cv::Point corner,
               const LearningLog& log,
               const LearningLog::Column& column,
               const std::vector<std::string>& series)
{
  std::vector<Curve> curves;
  std::vector<double> values;
  Range x;
  for (std::size_t s = 0; s < series.size(); ++s)
  {
    Curve curve;
    curve.colour = curveColour(s);
    for (std::size_t i = 0; i < log.step.size(); ++i)
    {
      if (log.series[i] == series[s] && isDrawable(log.step[i]) && isDrawable(column.value[i]))
      {
        curve.points.emplace_back(log.step[i], column.value[i]);
        values.push_back(column.value[i]);
        x.add(log.step[i]);
      }
    }
    curves.push_back(std::move(curve));
  }
  if (values.empty())
  {
    return;
  }
  x = x.size() > 0 ? x : Range{x.low - 1, x.high + 1};
  const cv::Rect area(corner.x + 90 * supersampling, corner.y + 50 * supersampling,
                      panel_width - 120 * supersampling, panel_height - 120 * supersampling);
  Panel panel(page, area, x, robustRange(values));
  panel.drawAxes(column.name, "step", "");
  for (auto& curve : curves)
  {
    if (curve.points.size() > max_unsmoothed_rows)
    {
      Curve faint = curve;
      faint.colour = 0.25 * curve.colour + 0.75 * white;
      faint.thickness = supersampling;
      panel.drawCurve(faint);
      curve = runningMean(curve);
    }
    panel.drawCurve(curve);
  }
}
}  // namespace

std::vector<std::uint8_t> renderLearningCurves(const LearningLog& log)
{
  if (log.step.empty() || log.columns.empty())
  {
    throw std::invalid_argument("renderLearningCurves: nothing to draw");
  }
  std::vector<std::string> series;
  for (const auto& s : log.series)
  {
    if (std::find(series.begin(), series.end(), s) == series.end())
    {
      series.push_back(s);
    }
  }
  const int across = std::min(panels_across, static_cast<int>(log.columns.size()));
  const int down = (static_cast<int>(log.columns.size()) + across - 1) / across;
  const int header_height = 40 * supersampling;
  const bool named = series.size() > 1 || !series.front().empty();
  const int footer = named ? (24 * static_cast<int>(series.size()) + 24) * supersampling : 0;
  cv::Mat page(header_height + down * panel_height + footer, across * panel_width, CV_8UC3, white);
  text(page, log.name, {page.cols / 2, 24 * supersampling}, Anchor::middle, 0.7);
  for (std::size_t c = 0; c < log.columns.size(); ++c)
  {
    const int k = static_cast<int>(c);
    drawPanel(page, {k % across * panel_width, header_height + k / across * panel_height}, log,
              log.columns[c], series);
  }
  if (named)
  {
    std::vector<Curve> legend(series.size());
    for (std::size_t s = 0; s < series.size(); ++s)
    {
      legend[s].name = series[s];
      legend[s].colour = curveColour(s);
    }
    drawLegend(page, {90 * supersampling, header_height + down * panel_height + 12 * supersampling},
               legend);
  }
  return encodePage(page);
}
}  // namespace dyslam
