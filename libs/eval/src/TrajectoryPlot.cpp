// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/TrajectoryPlot.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
// Drawn at twice the size and reduced, so that lines and text come out smooth.
constexpr int supersampling = 2;
constexpr int page_width = 1600 * supersampling;
constexpr int page_height = 800 * supersampling;

const cv::Scalar white(255, 255, 255);
const cv::Scalar ink(40, 40, 40);
const cv::Scalar faint(228, 228, 228);
const cv::Scalar frame_colour(150, 150, 150);
const cv::Scalar reference_grey(185, 185, 185);
// Blue, green, red; dark enough for white paper, apart for colour-blind eyes (Okabe and Ito).
const std::array<cv::Scalar, 7> curve_colours{cv::Scalar(178, 114, 0),  cv::Scalar(0, 94, 213),
                                              cv::Scalar(115, 158, 0),  cv::Scalar(167, 121, 204),
                                              cv::Scalar(0, 159, 230),  cv::Scalar(233, 180, 86),
                                              cv::Scalar(100, 100, 100)};

struct Curve
{
  std::string name;
  std::vector<Eigen::Vector2d> points;
  cv::Scalar colour;
  int thickness = 2 * supersampling;
};

struct Range
{
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double v)
  {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  [[nodiscard]] double size() const { return high - low; }
};

/** A step of 1, 2 or 5 times a power of ten that cuts `size` into at most `parts`. */
double niceStep(double size, int parts)
{
  const double raw = size / parts;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
  {
    if (factor * power >= raw * (1 - 1e-9))
    {
      return factor * power;
    }
  }
  return 10 * power;
}

std::string tickText(double value, double step)
{
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, std::abs(value) < step * 1e-6 ? 0.0 : value);
  return buffer;
}

enum class Anchor
{
  left,
  middle,
  right
};

void text(cv::Mat& page,
          const std::string& words,
          cv::Point at,
          Anchor anchor,
          double scale = 0.5,
          const cv::Scalar& colour = ink)
{
  const double size = scale * supersampling;
  int baseline = 0;
  const auto box = cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, supersampling, &baseline);
  at.x -= anchor == Anchor::middle ? box.width / 2 : anchor == Anchor::right ? box.width : 0;
  at.y += box.height / 2;
  cv::putText(page, words, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, supersampling, cv::LINE_AA);
}

void rotatedText(cv::Mat& page, const std::string& words, cv::Point center, double scale = 0.5)
{
  int baseline = 0;
  const double size = scale * supersampling;
  const auto box = cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, supersampling, &baseline);
  cv::Mat label(box.height + 2 * baseline, box.width, CV_8UC3, white);
  cv::putText(label, words, {0, box.height + baseline / 2}, cv::FONT_HERSHEY_SIMPLEX, size, ink,
              supersampling, cv::LINE_AA);
  cv::rotate(label, label, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect place(center.x - label.cols / 2, center.y - label.rows / 2, label.cols,
                       label.rows);
  const cv::Rect on_page = place & cv::Rect(0, 0, page.cols, page.rows);
  label(on_page - place.tl()).copyTo(page(on_page));
}

/** Axes with a grid and curves in a part of the page. */
class Panel
{
 public:
  Panel(cv::Mat& page, cv::Rect area, Range x, Range y) : page_(page), area_(area), x_(x), y_(y) {}

  void drawAxes(const std::string& title, const std::string& x_label, const std::string& y_label)
  {
    const double step_x = niceStep(x_.size(), 9);
    const double step_y = niceStep(y_.size(), area_.height > page_height / 2 ? 9 : 5);
    for (double v = std::ceil(x_.low / step_x - 1e-9) * step_x; v <= x_.high + 1e-9 * step_x;
         v += step_x)
    {
      const cv::Point p = pixel({v, y_.low});
      cv::line(page_, {p.x, area_.y}, {p.x, area_.y + area_.height}, faint, supersampling);
      text(page_, tickText(v, step_x), {p.x, area_.y + area_.height + 14 * supersampling},
           Anchor::middle, 0.42);
    }
    for (double v = std::ceil(y_.low / step_y - 1e-9) * step_y; v <= y_.high + 1e-9 * step_y;
         v += step_y)
    {
      const cv::Point p = pixel({x_.low, v});
      cv::line(page_, {area_.x, p.y}, {area_.x + area_.width, p.y}, faint, supersampling);
      text(page_, tickText(v, step_y), {area_.x - 8 * supersampling, p.y}, Anchor::right, 0.42);
    }
    cv::rectangle(page_, area_, frame_colour, supersampling);
    text(page_, title, {area_.x, area_.y - 14 * supersampling}, Anchor::left, 0.55);
    text(page_, x_label, {area_.x + area_.width / 2, area_.y + area_.height + 36 * supersampling},
         Anchor::middle);
    rotatedText(page_, y_label, {area_.x - 62 * supersampling, area_.y + area_.height / 2});
  }

  void drawCurve(const Curve& curve)
  {
    std::vector<cv::Point> line;
    for (const auto& p : curve.points)
    {
      line.push_back(pixel(p, curve_bits));
    }
    cv::Mat clipped = page_(area_);
    for (auto& p : line)
    {
      p -= cv::Point(area_.x << curve_bits, area_.y << curve_bits);
    }
    cv::polylines(clipped, std::vector<std::vector<cv::Point>>{line}, false, curve.colour,
                  curve.thickness, cv::LINE_AA, curve_bits);
  }

  void drawMark(const Eigen::Vector2d& at, const cv::Scalar& colour, bool square)
  {
    const cv::Point p = pixel(at);
    const int r = 5 * supersampling;
    if (square)
    {
      cv::rectangle(page_, p - cv::Point(r, r), p + cv::Point(r, r), colour, cv::FILLED);
    }
    else
    {
      cv::circle(page_, p, r, colour, cv::FILLED, cv::LINE_AA);
    }
  }

 private:
  static constexpr int curve_bits = 4;

  [[nodiscard]] cv::Point pixel(const Eigen::Vector2d& p, int bits = 0) const
  {
    const double unit = static_cast<double>(1 << bits);
    const double x = area_.x + (p.x() - x_.low) / x_.size() * area_.width;
    const double y = area_.y + (y_.high - p.y()) / y_.size() * area_.height;
    return {static_cast<int>(std::lround(x * unit)), static_cast<int>(std::lround(y * unit))};
  }

  cv::Mat& page_;
  cv::Rect area_;
  Range x_;
  Range y_;
};

std::pair<int, int> planeAxes(const PosePairs& pairs, TrajectoryPlotOptions::Plane plane)
{
  if (plane == TrajectoryPlotOptions::Plane::automatic)
  {
    std::array<Range, 3> spread;
    for (const auto& pose : pairs.reference)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        spread[static_cast<std::size_t>(axis)].add(pose.translation()[axis]);
      }
    }
    return spread[2].size() > spread[1].size() ? std::pair{0, 2} : std::pair{0, 1};
  }
  return plane == TrajectoryPlotOptions::Plane::xz ? std::pair{0, 2} : std::pair{0, 1};
}

/** The ranges widened about their centres until a metre is as long on both axes. */
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

std::vector<double> travelled(const std::vector<Pose>& poses)
{
  std::vector<double> lengths(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i)
  {
    lengths[i] = lengths[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths;
}

/** Error of the position over the distance travelled, after alignment. */
Curve positionErrorCurve(const PosePairs& pairs, const Pose& T_reference_estimate)
{
  Curve curve;
  const auto distance = travelled(pairs.reference);
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const Eigen::Vector3d aligned = T_reference_estimate * pairs.estimate[i].translation();
    curve.points.emplace_back(distance[i], (aligned - pairs.reference[i].translation()).norm());
  }
  return curve;
}

/** Translation error of each step over the distance travelled. */
Curve stepErrorCurve(const PosePairs& pairs)
{
  Curve curve;
  const auto distance = travelled(pairs.reference);
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i)
  {
    const Pose truth = pairs.reference[i].inverse() * pairs.reference[i + 1];
    const Pose estimated = pairs.estimate[i].inverse() * pairs.estimate[i + 1];
    curve.points.emplace_back(distance[i + 1], (estimated.inverse() * truth).translation().norm());
  }
  return curve;
}

void drawLegend(cv::Mat& page, cv::Point at, const std::vector<Curve>& curves)
{
  for (const auto& curve : curves)
  {
    cv::line(page, at, at + cv::Point(34 * supersampling, 0), curve.colour, curve.thickness,
             cv::LINE_AA);
    text(page, curve.name, at + cv::Point(42 * supersampling, 0), Anchor::left, 0.5);
    at.y += 24 * supersampling;
  }
}

void drawTopView(cv::Mat& page,
                 const std::vector<TrajectoryPlotItem>& items,
                 const TrajectoryPlotOptions& options)
{
  const auto [a, b] = planeAxes(items.front().pairs, options.plane);
  std::vector<Curve> curves;
  Curve reference;
  reference.name = "reference";
  reference.colour = reference_grey;
  reference.thickness = 7 * supersampling;
  for (const auto& pose : items.front().pairs.reference)
  {
    reference.points.emplace_back(pose.translation()[a], pose.translation()[b]);
  }
  curves.push_back(reference);
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const Pose T = alignEstimate(items[i].pairs, options.alignment);
    Curve curve;
    curve.name = items[i].name;
    curve.colour = curve_colours[i % curve_colours.size()];
    for (const auto& pose : items[i].pairs.estimate)
    {
      const Eigen::Vector3d p = T * pose.translation();
      curve.points.emplace_back(p[a], p[b]);
    }
    curves.push_back(curve);
  }
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
  const cv::Rect area(100 * supersampling, 70 * supersampling, 690 * supersampling,
                      660 * supersampling);
  equalScales(x, y, static_cast<double>(area.width) / area.height);
  Panel panel(page, area, x, y);
  const char* const axis_names[] = {"x [m]", "y [m]", "z [m]"};
  panel.drawAxes("From above, aligned: " + toString(options.alignment), axis_names[a],
                 axis_names[b]);
  for (const auto& curve : curves)
  {
    panel.drawCurve(curve);
  }
  panel.drawMark(curves.front().points.front(), ink, false);
  panel.drawMark(curves.front().points.back(), ink, true);
}

void drawErrors(cv::Mat& page, cv::Rect area, std::vector<Curve> curves, const char* title)
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
  panel.drawAxes(title, "distance travelled [m]", "error [m]");
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
  legend.front().name = "reference (dot: start, square: end)";
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
      curve->colour = curve_colours[i % curve_colours.size()];
    }
  }
  const int legend_height = (static_cast<int>(legend.size()) * 24 + 12) * supersampling;
  cv::Mat page(page_height + legend_height, page_width, CV_8UC3, white);
  text(page, options.title, {page_width / 2, 24 * supersampling}, Anchor::middle, 0.7);
  drawTopView(page, items, options);
  const cv::Rect upper(900 * supersampling, 70 * supersampling, 660 * supersampling,
                       270 * supersampling);
  drawErrors(page, upper, position_errors, "Position error after alignment");
  const cv::Rect lower(upper.x, 460 * supersampling, upper.width, 270 * supersampling);
  drawErrors(page, lower, step_errors, "Translation error of each step");
  drawLegend(page, {100 * supersampling, page_height}, legend);

  cv::Mat picture;
  cv::resize(page, picture, {}, 1.0 / supersampling, 1.0 / supersampling, cv::INTER_AREA);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", picture, bytes))
  {
    throw std::runtime_error("renderTrajectoryPlot: encoding the PNG failed");
  }
  return bytes;
}
}  // namespace dyslam
