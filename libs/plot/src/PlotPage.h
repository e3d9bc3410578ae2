// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace dyslam::plot
{
// Drawn at twice the final size and downsampled, for anti-aliasing.
constexpr int supersampling = 2;

const cv::Scalar white(255, 255, 255);
const cv::Scalar ink(40, 40, 40);
const cv::Scalar reference_grey(185, 185, 185);

/** Colour of the i-th curve; those of 21 curves differ. */
[[nodiscard]] cv::Scalar curveColour(std::size_t i);

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

  void add(double v);
  [[nodiscard]] double size() const { return high - low; }
};

enum class Anchor
{
  left,
  middle,
  right
};

/** UTF-8 text in the ASCII letters that the font has: Latin letters without accents, `?` for every
 * other character. */
[[nodiscard]] std::string drawable(const std::string& words);

/** Draws words as drawable() has them. */
void text(cv::Mat& page,
          const std::string& words,
          cv::Point at,
          Anchor anchor,
          double scale = 0.5,
          const cv::Scalar& colour = ink);

/** Axes with a grid and curves within an area of the page. */
class Panel
{
 public:
  /** \param steps approximate number of grid lines along y. */
  Panel(cv::Mat& page, cv::Rect area, Range x, Range y, int steps = 5);

  void drawAxes(const std::string& title, const std::string& x_label, const std::string& y_label);
  void drawCurve(const Curve& curve);
  void drawMark(const Eigen::Vector2d& at, const cv::Scalar& colour, bool square);

 private:
  [[nodiscard]] cv::Point pixel(const Eigen::Vector2d& p, int bits = 0) const;

  cv::Mat& page_;
  cv::Rect area_;
  Range x_;
  Range y_;
  int steps_;
};

/** Legend: names with line samples, downwards from `at` [px]. */
void drawLegend(cv::Mat& page, cv::Point at, const std::vector<Curve>& curves);

/** The page at its final size as PNG bytes.
 * \param levels number of levels of each colour channel: fewer make a smaller file */
[[nodiscard]] std::vector<std::uint8_t> encodePage(const cv::Mat& page, int levels = 256);
}  // namespace dyslam::plot
