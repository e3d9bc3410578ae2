// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/core/Ceilings.h>
#include <dyslam/core/MapGround.h>
#include <dyslam/plot/MapPicture.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "PlotPage.h"

namespace dyslam
{
namespace
{
using namespace plot;

constexpr double full_height = 4;   // height over the ground from which on points are darkest [m]
constexpr double point_side = 0.2;  // a point is drawn as large as a voxel of the map [m]
constexpr double lightest_grey = 214;
constexpr double darkest_grey = 70;
constexpr int line_bits = 4;  // fractional bits of pixel coordinates of lines

const std::vector<Eigen::Vector3f> no_points;

const cv::Scalar path_colour(190, 90, 20);  // colours are blue, green, red
const cv::Scalar start_colour(58, 143, 28);
const cv::Scalar end_colour(34, 34, 194);
const cv::Scalar loop_colour(200, 40, 200);
const cv::Vec3b marked_colour(30, 30, 225);

/** Colour and name of the kinds of objects that a picture tells apart. */
struct ObjectStyle
{
  const char* name;
  cv::Scalar colour;
};

const std::array<ObjectStyle, 4> styles{{{"vehicle", {40, 40, 214}},
                                         {"person", {14, 127, 255}},
                                         {"two-wheeler", {189, 60, 140}},
                                         {"unknown object", {115, 158, 0}}}};

const ObjectStyle& styleOf(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
    case ObjectClass::van:
    case ObjectClass::truck:
    case ObjectClass::bus:
      return styles[0];
    case ObjectClass::pedestrian:
      return styles[1];
    case ObjectClass::cyclist:
    case ObjectClass::motorcyclist:
      return styles[2];
    case ObjectClass::unknown:
      break;
  }
  return styles[3];
}

/** The part of the map that is shown, and where its points lie on the page. */
struct View
{
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  double scale = 1;  //!< page pixels per metre
  cv::Size size;

  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& p) const
  {
    return {(p.x() - low.x()) * scale, (high.y() - p.y()) * scale};
  }
  [[nodiscard]] cv::Point fine(const Eigen::Vector2d& p) const
  {
    const Eigen::Vector2d at = pixel(p) * (1 << line_bits);
    return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
  }
};

void include(View& view, const std::vector<Eigen::Vector3d>& path)
{
  for (const auto& p : path)
  {
    if (p.allFinite())
    {
      view.low = view.low.cwiseMin(p.head<2>());
      view.high = view.high.cwiseMax(p.head<2>());
    }
  }
}

/** How far nearly all points of the maps reach beyond the view, in x or y [m]; infinite without
 * points. */
double reachOfPoints(const std::vector<const MapPictureContent*>& contents, const View& view)
{
  std::vector<double> distances;
  for (const MapPictureContent* content : contents)
  {
    for (const auto& p : content->points != nullptr ? *content->points : no_points)
    {
      if (p.allFinite())
      {
        const Eigen::Vector2d at = p.head<2>().cast<double>();
        distances.push_back(
            std::max({0.0, (view.low - at).maxCoeff(), (at - view.high).maxCoeff()}));
      }
    }
  }
  return distances.empty() ? std::numeric_limits<double>::infinity() : quantile(distances, 0.995);
}

/** View of the part around all paths of the maps that are shown. */
View viewOf(const std::vector<const MapPictureContent*>& contents, const MapPictureOptions& options)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  View view{{infinity, infinity}, {-infinity, -infinity}, 1, {}};
  for (const MapPictureContent* content : contents)
  {
    include(view, content->path);
    for (const PictureRun& run : content->runs)
    {
      include(view, run.path);
    }
  }
  const double most = std::min(options.margin, reachOfPoints(contents, view) + 2);
  const Eigen::Vector2d margin(most, most);
  view.low -= margin;
  view.high += margin;
  const Eigen::Vector2d extent = view.high - view.low;
  view.scale = std::min(options.pixels / extent.maxCoeff(), 1 / options.min_pixel) * supersampling;
  view.size = {std::max(1, static_cast<int>(extent.x() * view.scale)),
               std::max(1, static_cast<int>(extent.y() * view.scale))};
  return view;
}

/** Calls `paint` with every pixel of the dot that a point is drawn as. */
template <typename Paint>
void drawDot(const Eigen::Vector3f& p, const View& view, cv::Mat& page, const Paint& paint)
{
  const int side = std::clamp(static_cast<int>(std::lround(point_side * view.scale)), 2, 12);
  const Eigen::Vector2d at = view.pixel(p.head<2>().cast<double>());
  const cv::Rect dot = cv::Rect(static_cast<int>(at.x()) - side / 2,
                                static_cast<int>(at.y()) - side / 2, side, side) &
                       cv::Rect({0, 0}, view.size);
  for (int y = dot.y; y < dot.y + dot.height; ++y)
  {
    for (int x = dot.x; x < dot.x + dot.width; ++x)
    {
      paint(page.at<cv::Vec3b>(y, x));
    }
  }
}

/** Draws the points: every pixel is as dark as its highest point over the ground, without
 * ceilings. */
void drawPoints(const std::vector<Eigen::Vector3f>& points, const View& view, cv::Mat& page)
{
  const MapGround ground(points);
  const std::vector<bool> is_ceiling = ceilingPoints(points, ground);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f& p = points[i];
    if (!p.allFinite() || is_ceiling[i])
    {
      continue;
    }
    const double share = std::clamp(ground.heightOver(p) / full_height, 0.0, 1.0);
    const auto grey = static_cast<unsigned char>(lightest_grey +
                                                 (darkest_grey - lightest_grey) * std::sqrt(share));
    drawDot(p, view, page,
            [grey](cv::Vec3b& pixel)
            {
              const unsigned char darker = std::min(pixel[0], grey);
              pixel = {darker, darker, darker};
            });
  }
}

void drawPath(const std::vector<Eigen::Vector3d>& path,
              const View& view,
              cv::Mat& page,
              const cv::Scalar& colour,
              int thickness,
              bool closed = false)
{
  std::vector<std::vector<cv::Point>> pieces(1);
  for (const auto& p : path)
  {
    if (p.allFinite())
    {
      pieces.back().push_back(view.fine(p.head<2>()));
    }
    else if (!pieces.back().empty())
    {
      pieces.emplace_back();
    }
  }
  cv::polylines(page, pieces, closed, colour, thickness, cv::LINE_AA, line_bits);
}

void drawObject(const PictureObject& object, const View& view, cv::Mat& page)
{
  const cv::Scalar& colour = styleOf(object.object_class).colour;
  drawPath(object.path, view, page, colour, 2 * supersampling);
  const Eigen::Vector2d ahead(std::cos(object.last.yaw), std::sin(object.last.yaw));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  std::vector<Eigen::Vector3d> box;
  for (const auto& [x, y] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}})
  {
    Eigen::Vector3d corner = object.last.centre;
    corner.head<2>() += 0.5 * (x * object.last.size.x() * ahead + y * object.last.size.y() * left);
    box.push_back(corner);
  }
  drawPath(box, view, page, colour, 2 * supersampling, true);
}

/** Draws a dot or a square with a white border. */
void drawMark(const Eigen::Vector3d& p,
              const View& view,
              cv::Mat& page,
              const cv::Scalar& colour,
              bool square)
{
  const Eigen::Vector2d at = view.pixel(p.head<2>());
  const cv::Point centre(static_cast<int>(at.x()), static_cast<int>(at.y()));
  const auto draw = [&](int pixels, const cv::Scalar& fill)
  {
    const int r = pixels * supersampling;
    if (square)
    {
      cv::rectangle(page, centre - cv::Point(r, r), centre + cv::Point(r, r), fill, cv::FILLED);
    }
    else
    {
      cv::circle(page, centre, r, fill, cv::FILLED, cv::LINE_AA);
    }
  };
  draw(8, white);
  draw(6, colour);
}

/** Marks start and end of a path. */
void drawEnds(const std::vector<Eigen::Vector3d>& path, const View& view, cv::Mat& page)
{
  const auto finite = [](const Eigen::Vector3d& p) { return p.allFinite(); };
  const auto first = std::find_if(path.begin(), path.end(), finite);
  const auto last = std::find_if(path.rbegin(), path.rend(), finite);
  if (first != path.end())
  {
    drawMark(*last, view, page, end_colour, true);
    drawMark(*first, view, page, start_colour, false);
  }
}

/** Adds a white strip below or above the picture. \return the strip */
cv::Mat addStrip(cv::Mat& page, int height, bool above)
{
  cv::copyMakeBorder(page, page, above ? height : 0, above ? 0 : height, 0, 0, cv::BORDER_CONSTANT,
                     white);
  return page.rowRange(above ? 0 : page.rows - height, above ? height : page.rows);
}

/** Draws a scale bar of a round length, about a sixth of the picture's width, at the right of a
 * strip. */
void drawScale(const View& view, cv::Mat& page)
{
  const double wanted = page.cols / view.scale / 6;
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  const double length = wanted < 2 * power ? power : wanted < 5 * power ? 2 * power : 5 * power;
  const int margin = 20 * supersampling;
  const cv::Point right(page.cols - margin, page.rows - margin / 2);
  const cv::Point left(right.x - static_cast<int>(length * view.scale), right.y);
  cv::line(page, left, right, ink, 3 * supersampling);
  const std::string words = formatted("%g m", length);
  text(page, words, {(left.x + right.x) / 2, right.y - 12 * supersampling}, Anchor::middle);
}

const char* const ends_text = " (green dot: start, red square: end)";

/** Entries of the legend. */
std::vector<Curve> runEntries(const std::vector<PictureRun>& runs)
{
  std::vector<Curve> entries;
  for (const PictureRun& run : runs)
  {
    const std::string name = drawable(run.name);
    const std::string number = "run " + std::to_string(entries.size() + 1);
    const bool is_readable = name.find('?') == std::string::npos;
    entries.push_back({"path of " + (is_readable ? name : number + " (" + name + ")") +
                           (entries.empty() ? ends_text : ""),
                       {},
                       curveColour(entries.size())});
  }
  return entries;
}

/** Adds a strip with a legend below the picture. */
cv::Mat addLegend(const std::vector<Curve>& entries, int lines, cv::Mat& page)
{
  cv::Mat strip = addStrip(page, (lines * 24 + 12) * supersampling, false);
  drawLegend(strip, {20 * supersampling, 18 * supersampling}, entries);
  return strip;
}

void drawLegendOf(const MapPictureContent& content, const View& view, cv::Mat& page)
{
  std::vector<Curve> entries = runEntries(content.runs);
  if (entries.empty())
  {
    entries.push_back({std::string("path of the sensor") + ends_text, {}, path_colour});
  }
  std::map<std::string, cv::Scalar> kinds;
  for (const auto& object : content.objects)
  {
    const ObjectStyle& style = styleOf(object.object_class);
    kinds.emplace(style.name, style.colour);
  }
  for (const auto& [name, colour] : kinds)
  {
    entries.push_back({std::string("moving ") + name, {}, colour});
  }
  if (!content.loops.empty())
  {
    entries.push_back({"loop", {}, loop_colour});
  }
  cv::Mat strip = addLegend(entries, static_cast<int>(entries.size()) + 1, page);
  drawScale(view, strip);
}

void requireValid(const MapPictureOptions& options)
{
  if (options.pixels <= 0 || !(options.margin > 0) || !(options.min_pixel > 0))
  {
    throw std::invalid_argument("renderMapPicture: an option is not positive");
  }
}

bool hasPath(const MapPictureContent& content)
{
  const auto isPath = [](const std::vector<Eigen::Vector3d>& path)
  { return std::any_of(path.begin(), path.end(), [](const auto& p) { return p.allFinite(); }); };
  return isPath(content.path) || std::any_of(content.runs.begin(), content.runs.end(),
                                             [&](const auto& run) { return isPath(run.path); });
}

cv::Mat drawMap(const MapPictureContent& content, const View& view)
{
  cv::Mat page(view.size, CV_8UC3, white);
  if (content.points != nullptr)
  {
    drawPoints(*content.points, view, page);
  }
  if (content.marked != nullptr)
  {
    for (const auto& p : *content.marked)
    {
      drawDot(p, view, page, [](cv::Vec3b& pixel) { pixel = marked_colour; });
    }
  }
  for (const auto& object : content.objects)
  {
    drawObject(object, view, page);
  }
  for (const auto& [from, to] : content.loops)
  {
    drawPath({from, to}, view, page, loop_colour, supersampling);
  }
  drawPath(content.path, view, page, path_colour, 3 * supersampling);
  for (std::size_t r = 0; r < content.runs.size(); ++r)
  {
    drawPath(content.runs[r].path, view, page, curveColour(r), 3 * supersampling);
  }
  drawEnds(content.path, view, page);
  for (const PictureRun& run : content.runs)
  {
    drawEnds(run.path, view, page);
  }
  return page;
}

void drawTitle(const std::string& title, const View& view, cv::Mat& page)
{
  constexpr int height = 36 * supersampling;
  cv::Mat strip = addStrip(page, height, true);
  text(strip, title, {20 * supersampling, height / 2}, Anchor::left);
  drawScale(view, strip);
}
}  // namespace

std::vector<std::uint8_t> renderMapPicture(const MapPictureContent& content,
                                           const MapPictureOptions& options)
{
  requireValid(options);
  if (!hasPath(content))
  {
    return {};
  }
  const View view = viewOf({&content}, options);
  cv::Mat page = drawMap(content, view);
  drawLegendOf(content, view, page);
  return encodePage(page);
}

std::vector<std::uint8_t> renderMapComparison(
    const std::pair<std::string, MapPictureContent>& first,
    const std::pair<std::string, MapPictureContent>& second,
    const MapPictureOptions& options)
{
  requireValid(options);
  if (!hasPath(first.second) && !hasPath(second.second))
  {
    return {};
  }
  const View view = viewOf({&first.second, &second.second}, options);
  std::vector<cv::Mat> pages;
  for (const auto* part : {&first, &second})
  {
    pages.push_back(drawMap(part->second, view));
    drawTitle(part->first, view, pages.back());
  }
  const bool wide = view.size.width > view.size.height;
  constexpr int gap = 6 * supersampling;
  const cv::Size border = wide ? cv::Size(view.size.width, gap) : cv::Size(gap, pages.front().rows);
  pages.insert(pages.begin() + 1, cv::Mat(border, CV_8UC3, ink));
  cv::Mat both;
  wide ? cv::vconcat(pages, both) : cv::hconcat(pages, both);
  const auto& runs = first.second.runs.empty() ? second.second.runs : first.second.runs;
  if (!runs.empty())
  {
    (void)addLegend(runEntries(runs), static_cast<int>(runs.size()), both);
  }
  constexpr int levels = 8;
  return encodePage(both, levels);
}
}  // namespace dyslam
