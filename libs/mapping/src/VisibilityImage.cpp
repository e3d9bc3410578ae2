// SPDX-License-Identifier: BSD-3-Clause
#include "VisibilityImage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr float pi = 3.14159265358979F;
constexpr float lowest = -35.0F * pi / 180.0F;  // elevation of the lower border
constexpr float highest = 37.0F * pi / 180.0F;  // and of the upper one
constexpr int widest_window = 4;                // pixels to each side
constexpr float nearest = 0.5F;                 // [m]

/** atan2 to 0.01 degrees: a pixel is 40 times that. */
float fastAtan2(float y, float x)
{
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float larger = std::max(ax, ay);
  if (larger <= 0)
  {
    return 0;
  }
  const float a = std::min(ax, ay) / larger;
  const float s = a * a;
  float r = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  r = ay > ax ? 0.5F * pi - r : r;
  r = x < 0 ? pi - r : r;
  return y < 0 ? -r : r;
}
}  // namespace

VisibilityImage::VisibilityImage(const std::vector<Eigen::Vector3f>& points,
                                 const Eigen::Vector3f& sensor)
    : sensor_(sensor),
      range_(static_cast<std::size_t>(rows) * cols, std::numeric_limits<float>::infinity())
{
  for (const auto& p : points)
  {
    const Eigen::Vector3f d = p - sensor;
    const float range = d.norm();
    if (!std::isfinite(range) || range < nearest)
    {
      continue;
    }
    const float elevation = fastAtan2(d.z(), std::hypot(d.x(), d.y()));
    const int row = static_cast<int>(std::floor((elevation - lowest) / (highest - lowest) * rows));
    if (row < 0 || row >= rows)
    {
      continue;
    }
    const int col = static_cast<int>((fastAtan2(d.y(), d.x()) + pi) / (2 * pi) * cols) % cols;
    float& cell = range_[static_cast<std::size_t>(row * cols + col)];
    cell = std::min(cell, range);
  }
}

bool VisibilityImage::seesThrough(const Eigen::Vector3f& p, float size, float margin) const
{
  constexpr float pixel = 2 * pi / cols;
  const Eigen::Vector3f d = p - sensor_;
  const float range = d.norm();
  if (!std::isfinite(range) || range < nearest)
  {
    return false;
  }
  const float elevation = fastAtan2(d.z(), std::sqrt(d.x() * d.x() + d.y() * d.y()));
  const int row = static_cast<int>(std::floor((elevation - lowest) / (highest - lowest) * rows));
  const int half =
      std::clamp(static_cast<int>(std::ceil(0.5F * size / range / pixel)), 1, widest_window);
  if (row < half || row >= rows - half)
  {
    return false;
  }
  const int col = static_cast<int>((fastAtan2(d.y(), d.x()) + pi) / (2 * pi) * cols) % cols;
  const float limit = range + margin;
  int rays = 0;
  for (int r = row - half; r <= row + half; ++r)
  {
    for (int c = col - half; c <= col + half; ++c)
    {
      const int wrapped = c < 0 ? c + cols : (c >= cols ? c - cols : c);
      const float seen = range_[static_cast<std::size_t>(r * cols + wrapped)];
      if (seen <= limit)
      {
        return false;
      }
      rays += std::isfinite(seen) ? 1 : 0;
    }
  }
  return rays > half;
}
}  // namespace dyslam
