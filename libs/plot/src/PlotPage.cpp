// SPDX-License-Identifier: BSD-3-Clause
#include "PlotPage.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string_view>

namespace dyslam::plot
{
namespace
{
constexpr int curve_bits = 4;
const cv::Scalar faint(228, 228, 228);
const cv::Scalar frame_colour(150, 150, 150);

/** Tick spacing of 1, 2 or 5 times a power of ten with at most `parts` intervals in `size`. */
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

/** Multiples of the step within the range; none where the step is lost in the numbers' last digit.
 */
std::vector<double> ticks(const Range& range, double step)
{
  constexpr double most = 100;
  std::vector<double> values;
  const double first = std::ceil(range.low / step - 1e-9) * step;
  const double count = std::floor((range.high + 1e-9 * step - first) / step);
  if (!(count >= 0 && count <= most) || first + step == first)
  {
    return values;
  }
  for (int i = 0; i <= static_cast<int>(count); ++i)
  {
    values.push_back(first + i * step);
  }
  return values;
}

std::string tickText(double value, double step)
{
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, std::abs(value) < step * 1e-6 ? 0.0 : value);
  return buffer;
}

void rotatedText(cv::Mat& page, const std::string& words, cv::Point centre, double scale = 0.5)
{
  int baseline = 0;
  const double size = scale * supersampling;
  const auto box = cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, supersampling, &baseline);
  cv::Mat label(box.height + 2 * baseline, box.width, CV_8UC3, white);
  cv::putText(label, words, {0, box.height + baseline / 2}, cv::FONT_HERSHEY_SIMPLEX, size, ink,
              supersampling, cv::LINE_AA);
  cv::rotate(label, label, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect place(centre.x - label.cols / 2, centre.y - label.rows / 2, label.cols,
                       label.rows);
  const cv::Rect on_page = place & cv::Rect(0, 0, page.cols, page.rows);
  label(on_page - place.tl()).copyTo(page(on_page));
}

/** The letter under a character's accent; empty for accents alone, `?` for other characters. */
std::string letterOf(unsigned code)
{
  constexpr unsigned first = 0xC0;
  static constexpr std::string_view letters =  // U+00C0 to U+017F
      "AAAAAAACEEEEIIIIDNOOOOOxOUUUUYTsaaaaaaaceeeeiiiidnooooo/ouuuuyty"
      "AaAaAaCcCcCcCcDdDdEeEeEeEeEeGgGgGgGgHhHhIiIiIiIiIiIiJjKkkLlLlLlL"
      "lLlNnNnNnnNnOoOoOoOoRrRrRrSsSsSsSsTtTtTtUuUuUuUuUuUuWwYyYZzZzZzs";
  constexpr unsigned sharp_s = 0xDF;
  if (code >= 0x300 && code < 0x370)  // combining accents
  {
    return "";
  }
  return code == sharp_s                                  ? "ss"
         : code >= first && code < first + letters.size() ? std::string(1, letters[code - first])
                                                          : "?";
}
}  // namespace

std::string drawable(const std::string& words)
{
  const auto byte = [&words](std::size_t i) { return static_cast<unsigned char>(words[i]); };
  std::string result;
  for (std::size_t i = 0; i < words.size();)
  {
    const std::size_t begin = i++;
    if (byte(begin) < 0x80)
    {
      result.push_back(words[begin]);
      continue;
    }
    while (i < words.size() && (byte(i) & 0xC0U) == 0x80)
    {
      ++i;
    }
    const bool two_bytes = i - begin == 2 && (byte(begin) & 0xE0U) == 0xC0;
    result += letterOf(two_bytes ? (byte(begin) & 0x1FU) << 6 | (byte(begin + 1) & 0x3FU) : 0);
  }
  return result;
}

cv::Scalar curveColour(std::size_t i)
{
  constexpr std::size_t rounds = 3;  // as they are, dark, light
  // Colour-blind safe palette (Okabe and Ito), in BGR.
  static const std::array<cv::Scalar, 7> colours{
      cv::Scalar(178, 114, 0),   cv::Scalar(0, 94, 213),  cv::Scalar(115, 158, 0),
      cv::Scalar(167, 121, 204), cv::Scalar(0, 159, 230), cv::Scalar(233, 180, 86),
      cv::Scalar(100, 100, 100)};
  const cv::Scalar& colour = colours[i % colours.size()];
  const std::size_t round = i / colours.size() % rounds;
  return round == 0 ? colour : round == 1 ? 0.5 * colour : 0.5 * (colour + white);
}

void Range::add(double v)
{
  low = std::min(low, v);
  high = std::max(high, v);
}

void text(cv::Mat& page,
          const std::string& words,
          cv::Point at,
          Anchor anchor,
          double scale,
          const cv::Scalar& colour)
{
  const std::string letters = drawable(words);
  const double size = scale * supersampling;
  int baseline = 0;
  const auto box =
      cv::getTextSize(letters, cv::FONT_HERSHEY_SIMPLEX, size, supersampling, &baseline);
  at.x -= anchor == Anchor::middle ? box.width / 2 : anchor == Anchor::right ? box.width : 0;
  at.y += box.height / 2;
  cv::putText(page, letters, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, supersampling,
              cv::LINE_AA);
}

Panel::Panel(cv::Mat& page, cv::Rect area, Range x, Range y, int steps)
    : page_(page), area_(area), x_(x), y_(y), steps_(steps)
{
}

void Panel::drawAxes(const std::string& title,
                     const std::string& x_label,
                     const std::string& y_label)
{
  const double step_x = niceStep(x_.size(), 9);
  const double step_y = niceStep(y_.size(), steps_);
  for (const double v : ticks(x_, step_x))
  {
    const cv::Point p = pixel({v, y_.low});
    cv::line(page_, {p.x, area_.y}, {p.x, area_.y + area_.height}, faint, supersampling);
    text(page_, tickText(v, step_x), {p.x, area_.y + area_.height + 14 * supersampling},
         Anchor::middle, 0.42);
  }
  for (const double v : ticks(y_, step_y))
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

void Panel::drawCurve(const Curve& curve)
{
  if (curve.points.size() == 1)
  {
    drawMark(curve.points.front(), curve.colour, false);
    return;
  }
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

void Panel::drawMark(const Eigen::Vector2d& at, const cv::Scalar& colour, bool square)
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

cv::Point Panel::pixel(const Eigen::Vector2d& p, int bits) const
{
  const double unit = static_cast<double>(1 << bits);
  const double x = area_.x + (p.x() - x_.low) / x_.size() * area_.width;
  const double y = area_.y + (y_.high - p.y()) / y_.size() * area_.height;
  // Coordinates are limited to positions far off the page.
  const auto whole = [unit](double value)
  {
    constexpr double farthest = 1e6;
    return std::isfinite(value)
               ? static_cast<int>(std::lround(std::clamp(value, -farthest, farthest) * unit))
               : 0;
  };
  return {whole(x), whole(y)};
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

std::vector<std::uint8_t> encodePage(const cv::Mat& page, int levels)
{
  cv::Mat picture;
  cv::resize(page, picture, {}, 1.0 / supersampling, 1.0 / supersampling, cv::INTER_AREA);
  cv::Mat table(1, 256, CV_8U);
  const double step = 255.0 / (levels - 1);
  for (int v = 0; v < 256; ++v)
  {
    table.at<std::uint8_t>(v) = static_cast<std::uint8_t>(std::lround(std::round(v / step) * step));
  }
  cv::LUT(picture, table, picture);
  constexpr int compression = 6;  // 9 takes five times as long for 2 % less
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, compression}))
  {
    throw std::runtime_error("a plot could not be encoded as PNG");
  }
  return bytes;
}
}  // namespace dyslam::plot
