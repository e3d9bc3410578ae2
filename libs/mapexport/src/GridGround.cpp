// SPDX-License-Identifier: BSD-3-Clause
#include "GridGround.h"

#include <dyslam/base/Quantile.h>
#include <dyslam/core/NeighbourSearch.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dyslam
{
namespace
{
constexpr double column_side = 1.0;        // [m]
constexpr int columns_around = 2;          // to each side
constexpr std::size_t fewest_columns = 6;  // for a slope
constexpr double on_plane = 0.08;          // largest distance of a column that a plane fits [m]
constexpr double slope_prior = 0.5;        // weight of no slope, for columns in a line [m^2]
constexpr int hanging_reach = 10;          // columns to each side whose ground is compared
constexpr double highest_step = 1.0;       // of the ground, besides its slope [m]

/** \param dx, dy columns from the one at `p` */
std::uint64_t columnKey(const Eigen::Vector2d& p, int dx = 0, int dy = 0)
{
  return voxelKey({cellNumber(p.x() / column_side) + dx, cellNumber(p.y() / column_side) + dy, 0});
}

std::vector<double> heightsOver(const Eigen::Vector2d& slope,
                                const std::vector<Eigen::Vector3d>& points)
{
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const Eigen::Vector3d& p : points)
  {
    heights.push_back(p.z() - slope.dot(p.head<2>()));
  }
  return heights;
}

double levelOn(const Eigen::Vector2d& slope, const std::vector<Eigen::Vector3d>& points)
{
  std::vector<double> heights = heightsOver(slope, points);
  return lowQuantile(heights, 4);
}

/** Slope of the plane that most points are near: weighted least squares whose weights (Geman and
 * McClure) get narrower. */
Eigen::Vector2d robustSlope(const std::vector<Eigen::Vector3d>& points)
{
  Eigen::Vector3d plane(levelOn(Eigen::Vector2d::Zero(), points), 0, 0);  // height, slope
  for (const double width : {1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.12, 0.08, 0.08})
  {
    Eigen::Matrix3d A = Eigen::Vector3d(1e-9, slope_prior, slope_prior).asDiagonal();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points)
    {
      const Eigen::Vector3d row(1, p.x(), p.y());
      const double ratio = (p.z() - row.dot(plane)) / width;
      const double weight = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
      A += weight * row * row.transpose();
      b += weight * p.z() * row;
    }
    plane = A.ldlt().solve(b);
    const double steepness = plane.tail<2>().norm();
    if (steepness > GridGround::max_slope)
    {
      plane.tail<2>() *= GridGround::max_slope / steepness;
      plane[0] = (b[0] - A.row(0).tail<2>().dot(plane.tail<2>())) / A(0, 0);
    }
  }
  return plane.tail<2>();
}

/** Largest number of points within twice `on_plane` of height over the slope. */
std::size_t support(const Eigen::Vector2d& slope, const std::vector<Eigen::Vector3d>& points)
{
  std::vector<double> heights = heightsOver(slope, points);
  std::sort(heights.begin(), heights.end());
  std::size_t most = 0;
  std::size_t first = 0;
  for (std::size_t last = 0; last < heights.size(); ++last)
  {
    while (heights[last] - heights[first] > 2 * on_plane)
    {
      ++first;
    }
    most = std::max(most, last + 1 - first);
  }
  return most;
}

/** Slope of most of the points; none where there is not one. */
std::optional<Eigen::Vector2d> commonSlope(const std::vector<Eigen::Vector3d>& points)
{
  if (points.size() < fewest_columns)
  {
    return std::nullopt;
  }
  const Eigen::Vector2d slope = robustSlope(points);
  const std::size_t level = support(Eigen::Vector2d::Zero(), points);
  const std::size_t sloped = support(slope, points);
  if (2 * std::max(level, sloped) < points.size())
  {
    return std::nullopt;
  }
  return sloped > level ? slope : Eigen::Vector2d::Zero();
}
}  // namespace

void GridGround::Column::add(const Eigen::Vector3f& p, std::uint32_t hits)
{
  if (p.z() < lowest.z())
  {
    lowest = p;
  }
  if (hits > 1 && p.z() < lowest_seen_twice.z())
  {
    lowest_seen_twice = p;
  }
}

bool GridGround::Column::isSeenTwice() const
{
  return std::isfinite(lowest_seen_twice.z());
}

GridGround::GridGround(const MapPoints& map, const std::vector<Eigen::Vector3d>& lidars)
{
  addColumns(map);
  std::vector<std::optional<Eigen::Vector2d>> slopes;
  slopes.reserve(columns_.size());
  for (const Column& column : columns_)
  {
    slopes.push_back(commonSlope(lowestAround(column)));
  }
  planes_.reserve(columns_.size());
  for (const Column& column : columns_)
  {
    const Eigen::Vector2d slope = slopeAround(column, slopes);
    planes_.push_back({levelOn(slope, lowestAround(column)), slope});
  }
  findHanging(lidars);
}

void GridGround::findHanging(const std::vector<Eigen::Vector3d>& lidars)
{
  const auto flat = [](const Eigen::Vector2d& p)
  { return Eigen::Vector3f(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F); };
  std::vector<Eigen::Vector3f> places;
  places.reserve(lidars.size());
  for (const Eigen::Vector3d& lidar : lidars)
  {
    places.push_back(flat(lidar.head<2>()));
  }
  const KdTree tree(places);
  for (std::size_t i = 0; i < columns_.size(); ++i)
  {
    Plane& plane = planes_[i];
    Neighbour nearest;
    plane.hangs = tree.nearest(flat(columns_[i].centre), nearest) &&
                  plane.height > lidars[nearest.index].z() &&
                  plane.height > highestGroundAt(columns_[i]);
  }
}

double GridGround::highestGroundAt(const Column& column) const
{
  double highest = std::numeric_limits<double>::infinity();
  forEachAround(column, hanging_reach,
                [&](std::size_t other)
                {
                  const double distance = (columns_[other].centre - column.centre).norm();
                  highest = std::min(highest, planes_[other].height + max_slope * distance);
                });
  return highest + highest_step;
}

void GridGround::addColumns(const MapPoints& map)
{
  for (std::size_t i = 0; i < map.size(); ++i)
  {
    const Eigen::Vector3f& p = map.points[i];
    const Eigen::Vector2d at = p.head<2>().cast<double>();
    const auto next = static_cast<std::uint32_t>(columns_.size());
    const auto found = index_.findOrInsert(columnKey(at), next);
    if (found == next)
    {
      columns_.emplace_back();
      columns_.back().centre = column_side * ((at / column_side).array().floor() + 0.5);
    }
    columns_[found].add(p, map.hits[i]);
  }
}

/** Median of the columns around that have a slope, so that a wrong one has no effect. */
Eigen::Vector2d GridGround::slopeAround(
    const Column& column, const std::vector<std::optional<Eigen::Vector2d>>& slopes) const
{
  std::vector<double> x;
  std::vector<double> y;
  forEachAround(column, columns_around,
                [&](std::size_t other)
                {
                  if (slopes[other])
                  {
                    x.push_back(slopes[other]->x());
                    y.push_back(slopes[other]->y());
                  }
                });
  return x.empty() ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(upperMedian(x), upperMedian(y));
}

double GridGround::above(const Eigen::Vector3d& p) const
{
  const auto found = index_.find(columnKey(p.head<2>()));
  if (found == VoxelHash::none)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Plane& plane = planes_[found];
  return p.z() - plane.height - plane.slope.dot(p.head<2>() - columns_[found].centre);
}

bool GridGround::isSeenAt(const Eigen::Vector3d& p) const
{
  const auto found = index_.find(columnKey(p.head<2>()));
  return found != VoxelHash::none && !planes_[found].hangs;
}

template <typename Use>
void GridGround::forEachAround(const Column& column, int reach, const Use& use) const
{
  for (int dx = -reach; dx <= reach; ++dx)
  {
    for (int dy = -reach; dy <= reach; ++dy)
    {
      const auto found = index_.find(columnKey(column.centre, dx, dy));
      if (found != VoxelHash::none)
      {
        use(found);
      }
    }
  }
}

/** Relative to the column's centre: of the columns that two keyframes saw, if there are any. */
std::vector<Eigen::Vector3d> GridGround::lowestAround(const Column& column) const
{
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> seen_twice;
  const Eigen::Vector3d centre(column.centre.x(), column.centre.y(), 0);
  forEachAround(column, columns_around,
                [&](std::size_t other)
                {
                  const Column& around = columns_[other];
                  points.emplace_back(around.lowest.cast<double>() - centre);
                  if (around.isSeenTwice())
                  {
                    seen_twice.emplace_back(around.lowest_seen_twice.cast<double>() - centre);
                  }
                });
  return seen_twice.empty() ? points : seen_twice;
}
}  // namespace dyslam
