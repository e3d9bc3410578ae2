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
constexpr double tile_size = 10;          // side of a tile [m]
constexpr double longest_way = 10;        // way within which a target is used again [m]
constexpr double ground_radius = 4;       // radius of the points that show the ground [m]
constexpr std::size_t ground_share = 10;  // one in so many points is below the ground
constexpr std::size_t least_ground = 5;   // number of points that show the ground
}  // namespace

std::optional<double> groundAmong(const std::vector<Eigen::Vector3f>& points, double x, double y)
{
  std::vector<float> heights;
  for (const Eigen::Vector3f& p : points)
  {
    if (std::hypot(p.x() - x, p.y() - y) < ground_radius)
    {
      heights.push_back(p.z());
    }
  }
  if (heights.size() < least_ground)
  {
    return std::nullopt;
  }
  return lowQuantile(heights, ground_share);
}

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

std::vector<Eigen::Vector3f> PriorMap::pointsBetween(const Tile& low, const Tile& high) const
{
  std::vector<Eigen::Vector3f> points;
  for (std::int32_t y = low.y; y <= high.y; ++y)
  {
    for (std::int32_t x = low.x; x <= high.x; ++x)
    {
      const auto tile = tiles_.find(keyOf({x, y}));
      if (tile != tiles_.end())
      {
        for (const std::uint32_t i : tile->second)
        {
          points.push_back(points_[i]);
        }
      }
    }
  }
  return points;
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
  KeyframeRegistrationOptions options;
  options.coarse_distance = 1.5;
  options.normal_radius = 1;
  target_.emplace(pointsBetween(tileOf(centre_->x() - reach, centre_->y() - reach),
                                tileOf(centre_->x() + reach, centre_->y() + reach)),
                  options);
  return *target_;
}

void PriorMap::exchangeState(StateArchive& archive)
{
  archive(centre_);
}

std::optional<double> PriorMap::groundHeight(double x, double y) const
{
  return groundAmong(pointsBetween(tileOf(x - ground_radius, y - ground_radius),
                                   tileOf(x + ground_radius, y + ground_radius)),
                     x, y);
}
}  // namespace dyslam
