// SPDX-License-Identifier: BSD-3-Clause
#include "PackedPoints.h"

#include <dyslam/core/Ceilings.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr double first_voxel = 0.05;                    // m
constexpr double voxel_growth = 1.2599210498948731648;  // the number of cubes halves, in space
constexpr double levels = 65535;

std::vector<std::uint32_t> finiteOnes(const std::vector<Eigen::Vector3f>& points)
{
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (points[i].allFinite())
    {
      chosen.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return chosen;
}

void append16(std::string& bytes, double value)
{
  const auto number = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, levels)));
  bytes += static_cast<char>(number & 0xFFU);
  bytes += static_cast<char>(number >> 8U);
}
}  // namespace

PackedPoints packPoints(const std::vector<Eigen::Vector3f>& points,
                        const std::vector<float>* intensity,
                        std::size_t max_points)
{
  if (max_points == 0 || (intensity != nullptr && intensity->size() != points.size()))
  {
    throw std::invalid_argument("packPoints: max_points is 0, or not one intensity per point");
  }
  PackedPoints packed;
  std::vector<std::uint32_t> chosen = finiteOnes(points);
  for (double voxel = first_voxel; chosen.size() > max_points; voxel *= voxel_growth)
  {
    packed.voxel_size = voxel;
    chosen = voxelDownsample(points, voxel).index;
  }
  packed.count = chosen.size();
  if (chosen.empty())
  {
    return packed;
  }
  const std::vector<bool> is_ceiling = ceilingPointsIfMany(points);
  const auto ceilings = std::stable_partition(chosen.begin(), chosen.end(),
                                              [&](std::uint32_t i) { return !is_ceiling[i]; });
  packed.ceilings = static_cast<std::size_t>(chosen.end() - ceilings);
  Eigen::Vector3f low = points[chosen.front()];
  Eigen::Vector3f high = low;
  for (const auto i : chosen)
  {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  packed.low = low.cast<double>();
  packed.step = (high.cast<double>() - packed.low) / levels;
  packed.bytes.reserve(7 * chosen.size());
  for (int axis = 0; axis < 3; ++axis)
  {
    const double step = packed.step[axis] > 0 ? packed.step[axis] : 1;
    for (const auto i : chosen)
    {
      append16(packed.bytes, (static_cast<double>(points[i][axis]) - packed.low[axis]) / step);
    }
  }
  for (const auto i : chosen)
  {
    const double value = intensity == nullptr ? 0 : static_cast<double>((*intensity)[i]);
    packed.bytes += static_cast<char>(
        std::lround(255 * (std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0.0)));
  }
  return packed;
}

std::string base64(std::string_view bytes)
{
  constexpr std::string_view alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3)
  {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
    {
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k)
    {
      text += i + k <= bytes.size() ? alphabet[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}
}  // namespace dyslam
