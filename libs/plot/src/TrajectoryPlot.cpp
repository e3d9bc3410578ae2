// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/plot/TrajectoryPlot.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "PlotPage.h"

namespace dyslam
{
namespace
{
using namespace plot;

constexpr int page_width = 1600 * supersampling;
constexpr int page_height = 800 * supersampling;

/** Axes of the ground plane. Vehicles and lidars have x forward and z up, cameras z forward. */
std::pair<int, int> groundAxes(const std::vector<Pose>& poses)
{
  Eigen::Vector3d distance = Eigen::Vector3d::Zero();  // along each body axis
  for (std::size_t i = 0; i + 1 < poses.size(); ++i)
  {
    distance += (poses[i].inverse() * poses[i + 1]).translation().cwiseAbs();
  }
  return distance.z() > distance.head<2>().norm() ? std::pair{0, 2} : std::pair{0, 1};
}

/** Widens the ranges about their centres to equal scales on both axes. */
void equalScales(Range& x, Range& y, double aspect)
{
  const double margin = 0.06 * std::max({x.size(), y.size(), 1.0});
  x = {x.low - margin, x.high + margin};
  y = {y.low - margin, y.high + margin};
  const auto widen = [](Range& r, double size)
  {
    const double more = 0.5 * (size - r.size());
    r = {r.low - more, r.high + more};
  };
  if (x.size() < aspect * y.size())
  {
    widen(x, aspect * y.size());
  }
  else
  {
    widen(y, x.size() / aspect);
  }
}

/** Error of the position over the distance travelled, after alignment. */
Curve positionErrorCurve(const PosePairs& pairs, const Pose& T_reference_estimate)
{
  Curve curve;
  const auto distance = distanceTravelled(pairs.reference);
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const Eigen::Vector3d aligned = T_reference_estimate * pairs.estimate[i].translation();
    curve.points.emplace_back(distance[i], (aligned - pairs.reference[i].translation()).norm());
  }
  return curve;
}

/** Translation error of each step over the distance travelled; empty without true orientations. */
Curve stepErrorCurve(const PosePairs& pairs)
{
  Curve curve;
  if (pairs.positions_only)
  {
    return curve;
  }
  const auto distance = distanceTravelled(pairs.reference);
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i)
  {
    const Pose truth = pairs.reference[i].inverse() * pairs.reference[i + 1];
    const Pose estimated = pairs.estimate[i].inverse() * pairs.estimate[i + 1];
    curve.points.emplace_back(distance[i + 1], (estimated.inverse() * truth).translation().norm());
  }
  return curve;
}

/** The reference of the estimate that covers most of it. */
const std::vector<Pose>& referenceOf(const std::vector<TrajectoryPlotItem>& items)
{
  const auto longest = std::max_element(items.begin(), items.end(),
                                        [](const TrajectoryPlotItem& a, const TrajectoryPlotItem& b)
                                        { return a.pairs.size() < b.pairs.size(); });
  return longest->pairs.reference;
}

/** Reference and aligned estimates in the plane of these axes. */
std::vector<Curve> alignedCurves(const std::vector<TrajectoryPlotItem>& items,
                                 Alignment alignment,
                                 std::pair<int, int> axes)
{
  const auto [a, b] = axes;
  std::vector<Curve> curves;
  Curve reference;
  reference.name = "reference";
  reference.colour = reference_grey;
  reference.thickness = 7 * supersampling;
  for (const auto& pose : referenceOf(items))
  {
    reference.points.emplace_back(pose.translation()[a], pose.translation()[b]);
  }
  curves.push_back(reference);
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const Pose T = alignEstimate(items[i].pairs, alignment);
    Curve curve;
    curve.name = items[i].name;
    curve.colour = curveColour(i);
    for (const auto& pose : items[i].pairs.estimate)
    {
      const Eigen::Vector3d p = T * pose.translation();
      curve.points.emplace_back(p[a], p[b]);
    }
    curves.push_back(curve);
  }
  return curves;
}

/** Start and end of the first curve are marked. */
void drawTopView(cv::Mat& page,
                 cv::Rect area,
                 const std::vector<Curve>& curves,
                 const std::string& title,
                 std::pair<int, int> axes)
{
  Range x;
  Range y;
  for (const auto& curve : curves)
  {
    for (const auto& p : curve.points)
    {
      x.add(p.x());
      y.add(p.y());
    }
  }
  equalScales(x, y, static_cast<double>(area.width) / area.height);
  Panel panel(page, area, x, y, 9);
  const char* const axis_names[] = {"x [m]", "y [m]", "z [m]"};
  panel.drawAxes(title, axis_names[axes.first], axis_names[axes.second]);
  for (const auto& curve : curves)
  {
    panel.drawCurve(curve);
  }
  panel.drawMark(curves.front().points.front(), ink, false);
  panel.drawMark(curves.front().points.back(), ink, true);
}

void drawErrors(cv::Mat& page,
                cv::Rect area,
                std::vector<Curve> curves,
                const std::string& title,
                const char* y_label)
{
  Range x;
  Range y;
  y.add(0);
  for (auto& curve : curves)
  {
    curve.thickness = 3 * supersampling / 2;
    for (const auto& p : curve.points)
    {
      x.add(p.x());
      y.add(p.y());
    }
  }
  x = std::isfinite(x.size()) && x.size() > 0 ? x : Range{0, 1};
  y = y.size() > 0 ? Range{0, 1.08 * y.high} : Range{0, 1};
  Panel panel(page, area, x, y);
  panel.drawAxes(title, "distance travelled [m]", y_label);
  for (const auto& curve : curves)
  {
    if (!curve.points.empty())
    {
      panel.drawCurve(curve);
    }
  }
}
}  // namespace

std::vector<std::uint8_t> renderTrajectoryPlot(const std::vector<TrajectoryPlotItem>& items,
                                               const TrajectoryPlotOptions& options)
{
  if (items.empty())
  {
    throw std::invalid_argument("renderTrajectoryPlot: nothing to draw");
  }
  std::vector<Curve> position_errors;
  std::vector<Curve> step_errors;
  std::vector<Curve> legend(1);
  const std::string& other = options.difference_to;
  legend.front().name = (other.empty() ? "reference" : other) + " (dot: start, square: end)";
  legend.front().colour = reference_grey;
  legend.front().thickness = 7 * supersampling;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    if (items[i].pairs.size() == 0)
    {
      throw std::invalid_argument("renderTrajectoryPlot: " + items[i].name + " has no poses");
    }
    const Pose T = alignEstimate(items[i].pairs, options.alignment);
    position_errors.push_back(positionErrorCurve(items[i].pairs, T));
    step_errors.push_back(stepErrorCurve(items[i].pairs));
    legend.emplace_back();
    legend.back().name = items[i].name;
    for (Curve* curve : {&position_errors.back(), &step_errors.back(), &legend.back()})
    {
      curve->colour = curveColour(i);
    }
  }
  const int legend_height = (static_cast<int>(legend.size()) * 24 + 12) * supersampling;
  cv::Mat page(page_height + legend_height, page_width, CV_8UC3, white);
  text(page, options.title, {page_width / 2, 24 * supersampling}, Anchor::middle, 0.7);
  const auto axes = groundAxes(referenceOf(items));
  const cv::Rect left(100 * supersampling, 70 * supersampling, 690 * supersampling,
                      660 * supersampling);
  drawTopView(page, left, alignedCurves(items, options.alignment, axes),
              "From above, " + describe(options.alignment), axes);
  const cv::Rect upper(900 * supersampling, 70 * supersampling, 660 * supersampling,
                       270 * supersampling);
  const char* const y_label = other.empty() ? "error [m]" : "difference [m]";
  drawErrors(page, upper, position_errors,
             other.empty() ? "Position error after alignment"
                           : "Difference of the position to " + other + ", after alignment",
             y_label);
  const cv::Rect lower(upper.x, 460 * supersampling, upper.width, 270 * supersampling);
  if (std::any_of(items.begin(), items.end(),
                  [](const TrajectoryPlotItem& item) { return !item.pairs.positions_only; }))
  {
    drawErrors(page, lower, step_errors,
               other.empty() ? "Translation error of each step"
                             : "Difference of the translation of each step to " + other,
               y_label);
  }
  drawLegend(page, {100 * supersampling, page_height}, legend);

  return encodePage(page);
}

std::vector<std::uint8_t> renderPaths(const std::vector<NamedPath>& paths)
{
  if (paths.empty())
  {
    throw std::invalid_argument("renderPaths: nothing to draw");
  }
  const auto axes = groundAxes(paths.front().poses);
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < paths.size(); ++i)
  {
    Curve curve;
    curve.name = paths[i].name + (i == 0 ? " (dot: start, square: end)" : "");
    curve.colour = curveColour(i);
    for (const Pose& pose : paths[i].poses)
    {
      const Eigen::Vector3d& p = pose.translation();
      if (p.allFinite())
      {
        curve.points.emplace_back(p[axes.first], p[axes.second]);
      }
    }
    if (curve.points.empty())
    {
      throw std::invalid_argument("renderPaths: " + paths[i].name + " has no poses");
    }
    curves.push_back(curve);
  }
  const int legend_height = (static_cast<int>(curves.size()) * 24 + 12) * supersampling;
  cv::Mat page(page_height + legend_height, page_width, CV_8UC3, white);
  const cv::Rect area(100 * supersampling, 70 * supersampling, 1460 * supersampling,
                      660 * supersampling);
  drawTopView(page, area, curves, "From above, as in the files", axes);
  drawLegend(page, {100 * supersampling, page_height}, curves);
  return encodePage(page);
}
}  // namespace dyslam
