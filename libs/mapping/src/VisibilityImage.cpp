// SPDX-License-Identifier: BSD-3-Clause
#include "VisibilityImage.h"

#include <dyslam/core/Deskew.h>
#include <dyslam/core/FastAngle.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr float pi = 3.14159265358979F;
constexpr float row_height = 0.4F * pi / 180.0F;
constexpr float horizon = 0.5F * row_height;  // row 0 begins there
constexpr int widest_window = 4;              // pixels to each side
constexpr float nearest = 0.5F;               // [m]

/** Rows above the horizon. */
int rowOf(const Eigen::Vector3f& ray)
{
  const float elevation =
      2 * pi * turnsOf(ray.z(), std::sqrt(ray.x() * ray.x() + ray.y() * ray.y()));
  return static_cast<int>(std::floor((elevation - horizon) / row_height));
}
}  // namespace

int VisibilityImage::columnOf(const Eigen::Vector3f& ray)
{
  return static_cast<int>((turnsOf(ray.y(), ray.x()) + 0.5F) * cols) % cols;
}

void VisibilityImage::setRows(const std::vector<Eigen::Vector3f>& points)
{
  int highest = 0;
  bool any = false;
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Vector3f ray = p - sensor_;
    if (ray.allFinite() && ray.norm() >= nearest)
    {
      const int row = rowOf(ray);
      lowest_ = any ? std::min(lowest_, row) : row;
      highest = any ? std::max(highest, row) : row;
      any = true;
    }
  }
  lowest_ -= widest_window;
  rows_ = any ? highest + widest_window + 1 - lowest_ : 0;
  range_.assign(static_cast<std::size_t>(rows_) * cols, std::numeric_limits<float>::infinity());
}

VisibilityImage::VisibilityImage(const Cloud& cloud, const Eigen::Vector3f& sensor)
    : sensor_(sensor)
{
  setRows(cloud.points);
  const bool timed = cloud.phase.size() == cloud.size() && !cloud.points.empty();
  const SweepMotion sweep(cloud.T_sweep, 0);
  std::vector<Eigen::Vector3f> sum(timed ? cols : 0, Eigen::Vector3f::Zero());
  std::vector<int> count(timed ? cols : 0, 0);
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    const Eigen::Vector3f origin = timed ? sweep.toReference(sensor, cloud.phase[i]) : sensor;
    const Eigen::Vector3f ray = cloud.points[i] - origin;
    const float range = ray.norm();
    if (!std::isfinite(range) || range < nearest)
    {
      continue;
    }
    const int col = columnOf(ray);
    if (timed)
    {
      sum[static_cast<std::size_t>(col)] += origin;
      ++count[static_cast<std::size_t>(col)];
    }
    const int row = rowOf(ray) - lowest_;
    if (row >= 0 && row < rows_)
    {
      float& cell = range_[static_cast<std::size_t>(row * cols + col)];
      cell = std::min(cell, range);
    }
  }
  setColumnOrigins(sum, count);
}

void VisibilityImage::setColumnOrigins(const std::vector<Eigen::Vector3f>& sum,
                                       const std::vector<int>& count)
{
  column_sensor_.assign(sum.size(), sensor_);
  for (std::size_t col = 0; col < sum.size(); ++col)
  {
    if (count[col] > 0)
    {
      column_sensor_[col] = sum[col] / static_cast<float>(count[col]);
    }
  }
}

Evidence VisibilityImage::at(const Eigen::Vector3f& p, float size, float margin) const
{
  constexpr float pixel = 2 * pi / cols;
  Eigen::Vector3f ray = p - sensor_;
  if (!ray.allFinite())
  {
    return Evidence::none;
  }
  if (!column_sensor_.empty())
  {
    ray = p - column_sensor_[static_cast<std::size_t>(columnOf(ray))];
  }
  const float range = ray.norm();
  if (range < nearest)
  {
    return Evidence::none;
  }
  const int row = rowOf(ray) - lowest_;
  const int half =
      std::clamp(static_cast<int>(std::ceil(0.5F * size / range / pixel)), 1, widest_window);
  if (row < half || row >= rows_ - half)
  {
    return Evidence::none;
  }
  const int col = columnOf(ray);
  int passed = 0;
  bool stopped = false;
  for (int r = row - half; r <= row + half; ++r)
  {
    for (int c = col - half; c <= col + half; ++c)
    {
      const int wrapped = c < 0 ? c + cols : (c >= cols ? c - cols : c);
      const float seen = range_[static_cast<std::size_t>(r * cols + wrapped)];
      if (std::abs(seen - range) <= margin)
      {
        return Evidence::occupied;
      }
      stopped = stopped || seen < range;
      passed += seen > range && std::isfinite(seen) ? 1 : 0;
    }
  }
  return !stopped && passed > half ? Evidence::free : Evidence::none;
}
}  // namespace dyslam
