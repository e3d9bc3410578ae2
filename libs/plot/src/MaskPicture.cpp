// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/plot/MaskPicture.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "PlotPage.h"

namespace dyslam
{
namespace
{
using namespace plot;

constexpr float half_side = 40;  // half side of the view [m]
constexpr int view_pixels = 720 * supersampling;
constexpr int margin = 48 * supersampling;
constexpr int curve_pixels = 420 * supersampling;

const cv::Scalar faint_grey(205, 205, 205);
const cv::Scalar dark_red(40, 40, 140);

cv::Scalar confidenceColour(float confidence)
{
  const double c = std::clamp(static_cast<double>(confidence), 0.0, 1.0);
  return {40 + 200 * c, 60, 40 + 200 * (1 - c)};
}

/** Pixel of a position; may lie outside the view. */
cv::Point pixelOf(const Eigen::Vector2f& p)
{
  constexpr float scale = static_cast<float>(view_pixels) / (2 * half_side);
  return {margin + static_cast<int>((half_side - p.y()) * scale),
          margin + static_cast<int>((half_side - p.x()) * scale)};
}

void drawView(const MaskScan& scan, cv::Mat& page)
{
  const cv::Rect area(margin, margin, view_pixels, view_pixels);
  std::vector<const MaskScan::Point*> inside;
  for (const auto& point : scan.points)
  {
    if (point.position.allFinite() && point.position.cwiseAbs().maxCoeff() < half_side)
    {
      inside.push_back(&point);
    }
  }
  for (const auto* point : inside)
  {
    const bool moves = point->truth == MaskScan::Truth::moving;
    cv::circle(page, pixelOf(point->position), moves ? 2 : 1, moves ? dark_red : faint_grey,
               cv::FILLED);
  }
  for (const auto* point : inside)
  {
    if (point->confidence >= 0)
    {
      const bool moves = point->truth == MaskScan::Truth::moving;
      cv::circle(page, pixelOf(point->position), (moves ? 5 : 3) * supersampling,
                 confidenceColour(point->confidence), cv::FILLED, cv::LINE_AA);
    }
  }
  cv::rectangle(page, area, ink, supersampling);
}

/** Legend and scale bar below the view. */
void drawLegendAndScale(cv::Mat& page)
{
  constexpr double text_size = 0.5;
  const int y = view_pixels + margin + 28 * supersampling;
  const auto write = [&](const char* words, int x, Anchor anchor) {
    text(page, words, {x, y + 5 * supersampling}, anchor, text_size);
  };
  constexpr int ramp_begin = margin + 120 * supersampling;
  constexpr int ramp_pixels = 160 * supersampling;
  write("moving", ramp_begin - 8 * supersampling, Anchor::right);
  for (int x = 0; x < ramp_pixels; ++x)
  {
    const float confidence = static_cast<float>(x) / static_cast<float>(ramp_pixels);
    cv::line(page, {ramp_begin + x, y - 6 * supersampling}, {ramp_begin + x, y + 6 * supersampling},
             confidenceColour(confidence));
  }
  write("static", ramp_begin + ramp_pixels + 8 * supersampling, Anchor::left);
  constexpr int dot = margin + 380 * supersampling;
  cv::circle(page, {dot, y}, 5 * supersampling, reference_grey, cv::FILLED, cv::LINE_AA);
  write("truly moving", dot + 12 * supersampling, Anchor::left);
  constexpr int bar_pixels = static_cast<int>(10 * view_pixels / (2 * half_side));
  const int bar = margin + view_pixels - bar_pixels;
  cv::rectangle(page, cv::Rect(bar, y - 2 * supersampling, bar_pixels, 4 * supersampling), ink,
                cv::FILLED);
  write("10 m", bar - 8 * supersampling, Anchor::right);
}
}  // namespace

std::vector<std::uint8_t> renderMaskScan(const MaskScan& scan)
{
  const auto roc = rocCurve(scan);
  const int width = view_pixels + 2 * margin + (roc.empty() ? 0 : curve_pixels + 2 * margin);
  cv::Mat page(view_pixels + 2 * margin, width, CV_8UC3, white);
  drawView(scan, page);
  drawLegendAndScale(page);
  text(page, scan.name, {margin + view_pixels / 2, 30 * supersampling}, Anchor::middle, 0.6);
  if (!roc.empty())
  {
    const cv::Rect area(view_pixels + 3 * margin, margin + (view_pixels - curve_pixels) / 2,
                        curve_pixels, curve_pixels);
    Panel panel(page, area, {0, 1}, {0, 1});
    const std::string title = formatted("area under the curve %.3f", areaUnderCurve(scan));
    panel.drawAxes(title, "false positive rate", "true positive rate");
    panel.drawCurve({"", {{0, 0}, {1, 1}}, reference_grey});
    panel.drawCurve({"", roc, curveColour(0)});
  }
  return encodePage(page);
}
}  // namespace dyslam
