// SPDX-License-Identifier: BSD-3-Clause
#include "VisibilityImage.h"

#include <dyslam/core/FastAngle.h>

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
    const float elevation = 2 * pi * turnsOf(d.z(), std::hypot(d.x(), d.y()));
    const int row = static_cast<int>(std::floor((elevation - lowest) / (highest - lowest) * rows));
    if (row < 0 || row >= rows)
    {
      continue;
    }
    const int col = static_cast<int>((turnsOf(d.y(), d.x()) + 0.5F) * cols) % cols;
    float& cell = range_[static_cast<std::size_t>(row * cols + col)];
    cell = std::min(cell, range);
  }
}

bool VisibilityImage::observesFree(const Eigen::Vector3f& p, float size, float margin) const
{
  constexpr float pixel = 2 * pi / cols;
  const Eigen::Vector3f d = p - sensor_;
  const float range = d.norm();
  if (!std::isfinite(range) || range < nearest)
  {
    return false;
  }
  const float elevation = 2 * pi * turnsOf(d.z(), std::sqrt(d.x() * d.x() + d.y() * d.y()));
  const int row = static_cast<int>(std::floor((elevation - lowest) / (highest - lowest) * rows));
  const int half =
      std::clamp(static_cast<int>(std::ceil(0.5F * size / range / pixel)), 1, widest_window);
  if (row < half || row >= rows - half)
  {
    return false;
  }
  const int col = static_cast<int>((turnsOf(d.y(), d.x()) + 0.5F) * cols) % cols;
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
