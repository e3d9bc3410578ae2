// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/MapQuality.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double flat = 1e-12;          // smallest eigenvalue that is not a rounding error [m^2]
constexpr std::size_t least_count = 4;  // fewer points always lie in a plane
}  // namespace

MapQuality::MapQuality(std::vector<Eigen::Vector3f> points, const MapQualityOptions& options)
    : points_(std::move(points)),
      options_(options),
      inverse_cell_(static_cast<float>(1 / options.radius)),
      moments_(points_.size())
{
  if (!(options.radius > 0) || options.min_neighbours < least_count)
  {
    throw std::invalid_argument("MapQuality: radius must be positive, min_neighbours at least 4");
  }
  for (std::size_t i = 0; i < points_.size(); ++i)
  {
    if (!points_[i].allFinite())
    {
      continue;
    }
    const VoxelCell cell = voxelCell(points_[i], inverse_cell_);
    for (int k = 0; k < 27; ++k)
    {
      const VoxelCell near{cell.x + k % 3 - 1, cell.y + k / 3 % 3 - 1, cell.z + k / 9 - 1};
      const auto list =
          cells_.findOrInsert(voxelKey(near), static_cast<std::uint32_t>(lists_.size()));
      if (list == lists_.size())
      {
        lists_.emplace_back();
      }
      lists_[list].push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void MapQuality::add(const std::vector<Eigen::Vector3f>& points)
{
  const auto limit = static_cast<float>(options_.radius * options_.radius);
  for (const auto& p : points)
  {
    const auto list =
        p.allFinite() ? cells_.find(voxelKey(voxelCell(p, inverse_cell_))) : VoxelHash::none;
    if (list == VoxelHash::none)
    {
      continue;
    }
    for (const auto i : lists_[list])
    {
      const Eigen::Vector3f difference = p - points_[i];
      if (difference.squaredNorm() <= limit)
      {
        const Eigen::Vector3d d = difference.cast<double>();
        Moments& moments = moments_[i];
        ++moments.count;
        moments.sum += d;
        moments.products += d * d.transpose();
      }
    }
  }
}

std::vector<std::optional<PointSharpness>> MapQuality::sharpness() const
{
  std::vector<std::optional<PointSharpness>> result;
  result.reserve(moments_.size());
  for (const Moments& moments : moments_)
  {
    result.emplace_back();
    if (moments.count < options_.min_neighbours)
    {
      continue;
    }
    const auto n = static_cast<double>(moments.count);
    const Eigen::Vector3d mean = moments.sum / n;
    const Eigen::Matrix3d covariance = moments.products / n - mean * mean.transpose();
    const Eigen::Vector3d eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
            .eigenvalues();
    if (eigenvalues.x() > flat)
    {
      const double entropy = 0.5 * (3 * std::log(2 * M_PI * M_E) + eigenvalues.array().log().sum());
      result.back() = PointSharpness{entropy, eigenvalues.x(), moments.count};
    }
  }
  return result;
}

std::vector<MapSharpness> meanSharpness(
    const std::vector<std::vector<std::optional<PointSharpness>>>& maps)
{
  std::vector<MapSharpness> result(maps.size());
  const std::size_t points = maps.empty() ? 0 : maps.front().size();
  for (const auto& map : maps)
  {
    if (map.size() != points)
    {
      throw std::invalid_argument("meanSharpness: different numbers of points");
    }
  }
  for (std::size_t i = 0; i < points; ++i)
  {
    bool in_all = true;
    for (const auto& map : maps)
    {
      in_all = in_all && map[i].has_value();
    }
    for (std::size_t m = 0; in_all && m < maps.size(); ++m)
    {
      ++result[m].points;
      result[m].mean_entropy += maps[m][i]->entropy;
      result[m].mean_plane_variance += maps[m][i]->plane_variance;
    }
  }
  for (MapSharpness& sharpness : result)
  {
    const double n = sharpness.points > 0 ? static_cast<double>(sharpness.points)
                                          : std::numeric_limits<double>::quiet_NaN();
    sharpness.mean_entropy /= n;
    sharpness.mean_plane_variance /= n;
  }
  return result;
}
}  // namespace dyslam
