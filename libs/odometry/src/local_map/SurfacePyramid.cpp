// SPDX-License-Identifier: BSD-3-Clause
#include "SurfacePyramid.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
/** Growth of the limit of points per cell from level to level, as the area of a cell. */
constexpr double count_growth = 4;
}  // namespace

SurfacePyramid::SurfacePyramid(double cell_size, int levels, double max_count, ThreadPool& pool)
    : cell_size_(cell_size), max_count_(max_count), pool_(&pool)
{
  restart(cell_size, levels);
}

void SurfacePyramid::restart(double cell_size, int levels)
{
  cell_size_ = cell_size;
  levels = std::clamp(levels, 1, max_levels);
  levels_.clear();
  levels_.reserve(static_cast<std::size_t>(levels));
  double max_count = max_count_;
  for (int level = 0; level < levels; ++level)
  {
    levels_.emplace_back(cell_size, max_count, *pool_);
    cell_size *= 2;
    max_count *= count_growth;
  }
}

SurfacePyramid::Base SurfacePyramid::baseAt(const Eigen::Vector3d& p) const
{
  Base base;
  for (std::size_t level = 0; level < levels_.size(); ++level)
  {
    base.cell[level] = levels_[level].cellOf(p);
    const Eigen::Vector3d corner = levels_[level].corner(base.cell[level]);
    base.origin = level == 0 ? corner : base.origin;
    base.shift[level] = (base.origin - corner).cast<float>();
  }
  return base;
}

Surface SurfacePyramid::surfaceAt(const Eigen::Vector3f& p,
                                  const Base& base,
                                  float min_planarity) const
{
  for (std::size_t level = 0; level < levels_.size(); ++level)
  {
    Surface surface = levels_[level].surfaceAt(p + base.shift[level], base.cell[level]);
    if (surface.planarity > min_planarity)
    {
      surface.mean -= base.shift[level];
      return surface;
    }
  }
  return {};
}

void SurfacePyramid::add(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<float>& weights,
                         const Pose& T_map_body)
{
  for (SurfaceMap& level : levels_)
  {
    level.add(points, weights, T_map_body);
  }
}

SurfacePyramid SurfacePyramid::coarser(int factor) const
{
  SurfacePyramid coarse(cell_size_ * factor, 1, max_count_, *pool_);
  coarse.levels_.clear();
  coarse.levels_.push_back(levels_.front().coarser(factor));
  return coarse;
}

void SurfacePyramid::crop(const Eigen::Vector3d& centre, double radius)
{
  for (SurfaceMap& level : levels_)
  {
    level.crop(centre, radius);
  }
}

void SurfacePyramid::clear()
{
  for (SurfaceMap& level : levels_)
  {
    level.clear();
  }
}

void SurfacePyramid::exchangeState(StateArchive& archive)
{
  double cell_size = cell_size_;
  int count = levels();
  archive(cell_size, count);
  if (archive.isLoading())
  {
    if (!(cell_size > 0) || count < 1 || count > max_levels)
    {
      throw UserError("the state of the run has an invalid local map");
    }
    restart(cell_size, count);
  }
  for (SurfaceMap& level : levels_)
  {
    archive(level);
  }
}
}  // namespace dyslam
