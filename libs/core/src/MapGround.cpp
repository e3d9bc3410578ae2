// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/core/MapGround.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr double square_side = 2;  // [m]
constexpr float max_pit = 0.5F;    // largest depth of a square's ground below its neighbours' [m]
constexpr std::int64_t row = 1LL << 32;

std::int64_t keyOf(const Eigen::Vector3f& p)
{
  const auto number = [](float v)
  { return static_cast<std::int64_t>(std::floor(static_cast<double>(v) / square_side)); };
  return number(p.x()) * row + number(p.y());
}

/** Heights of those of the square and the eight around it that are known [m]. */
std::vector<float> heightsAround(const std::unordered_map<std::int64_t, float>& heights,
                                 std::int64_t key)
{
  std::vector<float> values;
  for (int k = 0; k < 9; ++k)
  {
    const auto found = heights.find(key + (k / 3 - 1) * row + k % 3 - 1);
    if (found != heights.end())
    {
      values.push_back(found->second);
    }
  }
  return values;
}
}  // namespace

MapGround::MapGround(const std::vector<Eigen::Vector3f>& points)
{
  std::unordered_map<std::int64_t, std::vector<float>> heights;
  for (const auto& p : points)
  {
    if (p.allFinite())
    {
      heights[keyOf(p)].push_back(p.z());
    }
  }
  std::unordered_map<std::int64_t, float> low;
  for (auto& [key, values] : heights)
  {
    low[key] = lowQuantile(values, 10);
  }
  for (const auto& [key, height] : low)
  {
    std::vector<float> values = heightsAround(low, key);
    const float around = upperMedian(values);
    ground_[key] = height < around - max_pit ? around : height;
  }
  for (const auto& [key, height] : ground_)
  {
    const std::vector<float> values = heightsAround(ground_, key);
    lowest_[key] = *std::min_element(values.begin(), values.end());
  }
}

double MapGround::heightOver(const Eigen::Vector3f& p) const
{
  return static_cast<double>(p.z() - ground_.at(keyOf(p)));
}

double MapGround::heightOverLowest(const Eigen::Vector3f& p) const
{
  return static_cast<double>(p.z() - lowest_.at(keyOf(p)));
}
}  // namespace dyslam
