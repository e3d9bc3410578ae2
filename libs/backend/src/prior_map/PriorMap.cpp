// SPDX-License-Identifier: BSD-3-Clause
#include "PriorMap.h"

#include <dyslam/base/Quantile.h>
#include <dyslam/base/StateArchive.h>

#include <cmath>
#include <cstddef>

namespace dyslam
{
namespace
{
constexpr double voxel_size = 0.3;        // voxel size of the target [m]
constexpr double tile_size = 10;          // side of a tile [m]
constexpr double longest_way = 10;        // way within which a target is used again [m]
constexpr double ground_radius = 4;       // radius of the points that show the ground [m]
constexpr std::size_t ground_share = 10;  // one in so many points is below the ground
constexpr std::size_t least_ground = 5;   // number of points that show the ground
}  // namespace

PriorMap::Tile PriorMap::tileOf(double x, double y)
{
  return {cellNumber(x / tile_size), cellNumber(y / tile_size)};
}

PriorMap::PriorMap(const std::vector<Eigen::Vector3f>& points, double range)
    : range_(range), points_(voxelDownsample(points, voxel_size, VoxelPick::centroid).points)
{
  for (std::size_t i = 0; i < points_.size(); ++i)
  {
    tiles_[keyOf(tileOf(points_[i].x(), points_[i].y()))].push_back(static_cast<std::uint32_t>(i));
  }
}

RegistrationTarget& PriorMap::around(const Eigen::Vector3d& position)
{
  const bool is_near = centre_ && (position - *centre_).head<2>().norm() <= longest_way;
  if (is_near && target_)
  {
    return *target_;
  }
  centre_ = is_near ? *centre_ : position;
  const double reach = range_ + longest_way;
  const Tile low = tileOf(centre_->x() - reach, centre_->y() - reach);
  const Tile high = tileOf(centre_->x() + reach, centre_->y() + reach);
  std::vector<Eigen::Vector3f> near;
  for (std::int32_t y = low.y; y <= high.y; ++y)
  {
    for (std::int32_t x = low.x; x <= high.x; ++x)
    {
      const auto tile = tiles_.find(keyOf({x, y}));
      if (tile != tiles_.end())
      {
        for (const std::uint32_t i : tile->second)
        {
          near.push_back(points_[i]);
        }
      }
    }
  }
  KeyframeRegistrationOptions options;
  options.coarse_distance = 1.5;
  options.normal_radius = 1;
  target_.emplace(std::move(near), options);
  return *target_;
}

void PriorMap::exchangeState(StateArchive& archive)
{
  archive(centre_);
}

std::optional<double> PriorMap::groundHeight(double x, double y) const
{
  std::vector<float> heights;
  const Tile low = tileOf(x - ground_radius, y - ground_radius);
  const Tile high = tileOf(x + ground_radius, y + ground_radius);
  for (std::int32_t ty = low.y; ty <= high.y; ++ty)
  {
    for (std::int32_t tx = low.x; tx <= high.x; ++tx)
    {
      const auto tile = tiles_.find(keyOf({tx, ty}));
      if (tile == tiles_.end())
      {
        continue;
      }
      for (const std::uint32_t i : tile->second)
      {
        const Eigen::Vector3f& p = points_[i];
        if (std::hypot(p.x() - x, p.y() - y) < ground_radius)
        {
          heights.push_back(p.z());
        }
      }
    }
  }
  if (heights.size() < least_ground)
  {
    return std::nullopt;
  }
  return lowQuantile(heights, ground_share);
}
}  // namespace dyslam
