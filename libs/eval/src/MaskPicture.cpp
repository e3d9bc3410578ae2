// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/AreaUnderCurve.h>
#include <dyslam/core/Error.h>
#include <dyslam/eval/MaskPicture.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "PlotPage.h"

namespace dyslam
{
namespace
{
using namespace plot;

constexpr std::string_view header = "x,y,z,static_confidence,label";
constexpr float half_side = 40;  // m
constexpr int view_pixels = 720 * supersampling;
constexpr int margin = 48 * supersampling;
constexpr int curve_pixels = 420 * supersampling;

const cv::Scalar faint_grey(205, 205, 205);
const cv::Scalar dark_red(40, 40, 140);

/** A sampled point whose true label is known. */
struct Sample
{
  float confidence;  //!< that it is static
  bool moving;       //!< by its label
};

std::vector<Sample> labelledSamples(const MaskScan& scan)
{
  std::vector<Sample> samples;
  for (const auto& point : scan.points)
  {
    if (point.confidence >= 0 && point.truth != MaskScan::Truth::unknown)
    {
      samples.push_back({point.confidence, point.truth == MaskScan::Truth::moving});
    }
  }
  return samples;
}

bool parseRow(std::string_view row, std::array<float, 5>& values)
{
  const char* at = row.data();
  const char* end = at + row.size();
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool last = i + 1 == values.size();
    if (error != std::errc() || (last ? next != end : next == end || *next != ','))
    {
      return false;
    }
    at = last ? next : next + 1;
  }
  return true;
}

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

MaskScan parseMaskScan(const std::string& content, const std::string& name)
{
  MaskScan scan;
  scan.name = name;
  std::string_view rest = content;
  bool first = true;
  while (!rest.empty())
  {
    const auto end = std::min(rest.find('\n'), rest.size());
    std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!row.empty() && row.back() == '\r')
    {
      row.remove_suffix(1);
    }
    if (first)
    {
      if (row != header)
      {
        throw UserError(name + ": the first line must be " + std::string(header) +
                        "; give a file of dyslam-train dylo --mask-csv");
      }
      first = false;
      continue;
    }
    std::array<float, 5> v{};
    const auto reject = [&](const char* what)
    { throw UserError(name + ": row " + std::to_string(scan.points.size() + 1) + what); };
    if (!parseRow(row, v))
    {
      reject(" is not five numbers with commas between");
    }
    if (!(v[3] <= 1))
    {
      reject(": static_confidence must be at most 1, or below 0 for none");
    }
    if (v[4] != 0 && v[4] != 1 && v[4] != 2)
    {
      reject(": label must be 0 (unknown), 1 (static) or 2 (moving)");
    }
    const auto truth = v[4] == 1   ? MaskScan::Truth::stationary
                       : v[4] == 2 ? MaskScan::Truth::moving
                                   : MaskScan::Truth::unknown;
    scan.points.push_back({{v[0], v[1]}, v[3], truth});
  }
  if (scan.points.empty())
  {
    throw UserError(name + ": no rows; write it again with dyslam-train dylo --mask-csv");
  }
  return scan;
}

std::vector<Eigen::Vector2d> rocCurve(const MaskScan& scan)
{
  std::vector<Sample> samples = labelledSamples(scan);
  const auto all_moving = static_cast<double>(
      std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.moving; }));
  const double all_static = static_cast<double>(samples.size()) - all_moving;
  if (all_moving == 0 || all_static == 0)
  {
    return {};
  }
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.confidence < b.confidence; });
  std::vector<Eigen::Vector2d> curve = {Eigen::Vector2d::Zero()};
  double moving = 0;
  double static_count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    (samples[i].moving ? moving : static_count) += 1;
    // Equal confidences are called moving together.
    if (i + 1 == samples.size() || samples[i].confidence < samples[i + 1].confidence)
    {
      curve.emplace_back(static_count / all_static, moving / all_moving);
    }
  }
  return curve;
}

double areaUnderCurve(const MaskScan& scan)
{
  std::vector<float> still;
  std::vector<float> moving;
  for (const Sample& sample : labelledSamples(scan))
  {
    (sample.moving ? moving : still).push_back(sample.confidence);
  }
  return areaUnderCurve(std::move(still), moving);
}

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
    char title[48];
    std::snprintf(title, sizeof title, "area under the curve %.3f", areaUnderCurve(scan));
    panel.drawAxes(title, "false positive rate", "true positive rate");
    panel.drawCurve({"", {{0, 0}, {1, 1}}, reference_grey});
    panel.drawCurve({"", roc, curveColour(0)});
  }
  return encodePage(page);
}
}  // namespace dyslam
