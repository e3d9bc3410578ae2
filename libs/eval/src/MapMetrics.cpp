// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Statistics.h>
#include <dyslam/core/Labels.h>
#include <dyslam/eval/MapMetrics.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace dyslam
{
namespace
{
struct CellHash
{
  std::size_t operator()(const std::array<std::int64_t, 3>& c) const
  {
    std::uint64_t h = 1469598103934665603ULL;
    for (const std::int64_t v : c)
    {
      h = (h ^ static_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ULL;
      h ^= h >> 29U;
    }
    return static_cast<std::size_t>(h);
  }
};
using Cell = std::array<std::int64_t, 3>;

/** Points beyond 1e15 cells are in the last cell. \pre p is finite */
Cell cellOf(const Eigen::Vector3f& p, double size)
{
  constexpr double last = 1e15;
  const Eigen::Vector3d cell = (p.cast<double>() / size).array().floor().max(-last).min(last);
  return {static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
          static_cast<std::int64_t>(cell.z())};
}

/** Hash grid of points; the cell size is the search radius. */
class PointGrid
{
 public:
  PointGrid(const std::vector<Eigen::Vector3f>& points, double radius)
      : points_(points), radius_(radius)
  {
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      if (points[i].allFinite())
      {
        cells_[cellOf(points[i], radius)].push_back(i);
      }
    }
  }

  [[nodiscard]] bool hasNear(const Eigen::Vector3f& p) const
  {
    const Cell centre = cellOf(p, radius_);
    const double limit = radius_ * radius_;
    for (std::int64_t dx = -1; dx <= 1; ++dx)
    {
      for (std::int64_t dy = -1; dy <= 1; ++dy)
      {
        for (std::int64_t dz = -1; dz <= 1; ++dz)
        {
          const auto it = cells_.find({centre[0] + dx, centre[1] + dy, centre[2] + dz});
          if (it != cells_.end() && anyWithin(it->second, p, limit))
          {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] bool anyWithin(const std::vector<std::size_t>& candidates,
                               const Eigen::Vector3f& p,
                               double squared_limit) const
  {
    for (const std::size_t i : candidates)
    {
      if ((points_[i] - p).cast<double>().squaredNorm() <= squared_limit)
      {
        return true;
      }
    }
    return false;
  }

  const std::vector<Eigen::Vector3f>& points_;
  double radius_;
  std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells_;
};

void count(MapScores& scores, bool dynamic, bool present)
{
  if (dynamic)
  {
    ++scores.dynamic_total;
    scores.dynamic_rejected += present ? 0 : 1;
  }
  else
  {
    ++scores.static_total;
    scores.static_preserved += present ? 1 : 0;
  }
}

MapScores scoreVoxels(const std::vector<Eigen::Vector3f>& reference,
                      const std::vector<std::uint32_t>& labels,
                      const std::vector<Eigen::Vector3f>& estimate,
                      double size)
{
  std::unordered_map<Cell, bool, CellHash> is_dynamic;
  MapScores scores;
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    if (!reference[i].allFinite() || isIgnoredLabel(labels[i]))
    {
      ++scores.unlabelled;
      continue;
    }
    const bool dynamic = isMovingLabel(labels[i]);
    const auto [entry, is_new] = is_dynamic.try_emplace(cellOf(reference[i], size), dynamic);
    entry->second = entry->second && dynamic;
  }
  std::unordered_set<Cell, CellHash> estimated;
  for (const auto& p : estimate)
  {
    if (p.allFinite())
    {
      estimated.insert(cellOf(p, size));
    }
  }
  for (const auto& [cell, dynamic] : is_dynamic)
  {
    count(scores, dynamic, estimated.count(cell) > 0);
  }
  return scores;
}
}  // namespace

std::optional<double> MapScores::preservation() const
{
  return ratio(static_preserved, static_total);
}

std::optional<double> MapScores::rejection() const
{
  return ratio(dynamic_rejected, dynamic_total);
}

std::optional<double> harmonicMean(std::optional<double> a, std::optional<double> b)
{
  if (!a || !b)
  {
    return std::nullopt;
  }
  return *a + *b > 0 ? 2 * *a * *b / (*a + *b) : 0.0;
}

std::optional<double> geometricMean(std::optional<double> a, std::optional<double> b)
{
  if (!a || !b)
  {
    return std::nullopt;
  }
  return std::sqrt(*a * *b);
}

MapEvaluation evaluateMap(const std::vector<Eigen::Vector3f>& reference,
                          const std::vector<std::uint32_t>& labels,
                          const std::vector<Eigen::Vector3f>& estimate,
                          const MapMetricsOptions& options)
{
  if (labels.size() != reference.size())
  {
    throw std::invalid_argument("evaluateMap: " + std::to_string(reference.size()) +
                                " points, but " + std::to_string(labels.size()) + " labels");
  }
  if (!(options.point_radius > 0) || !(options.voxel_size > 0))
  {
    throw std::invalid_argument("evaluateMap: radius and voxel size must be positive");
  }
  MapEvaluation result;
  const PointGrid grid(estimate, options.point_radius);
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    if (!reference[i].allFinite() || isIgnoredLabel(labels[i]))
    {
      ++result.points.unlabelled;
      continue;
    }
    count(result.points, isMovingLabel(labels[i]), grid.hasNear(reference[i]));
  }
  result.voxels = scoreVoxels(reference, labels, estimate, options.voxel_size);
  return result;
}
}  // namespace dyslam
