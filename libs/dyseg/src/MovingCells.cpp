// SPDX-License-Identifier: BSD-3-Clause
#include "MovingCells.h"

#include <algorithm>
#include <cmath>

#include "ConnectedComponents.h"

namespace dyslam
{
MovingCells::MovingCells(const std::vector<Eigen::Vector3f>& points,
                         const ResidualSegmenterOptions& options)
    : options_(options),
      cells_per_metre_(static_cast<float>(1 / options.cell_size)),
      half_width_(static_cast<int>(std::ceil(options.max_range / options.cell_size)) + 1),
      width_(2 * half_width_ + 1),
      cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_))
{
  std::vector<int> cell_of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    cell_of[i] = cellOf(points[i]);
    if (cell_of[i] >= 0)
    {
      at(cell_of[i]).lowest = std::min(at(cell_of[i]).lowest, points[i].z());
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const int cell = cell_of[i];
    if (cell >= 0 &&
        points[i].z() >= lowestAround(cell) + static_cast<float>(options_.ground_clearance))
    {
      candidates_.push_back(static_cast<std::uint32_t>(i));
      candidate_cells_.push_back(cell);
    }
  }
}

int MovingCells::cellOf(const Eigen::Vector3f& p) const
{
  if (!(p.head<2>().norm() <= static_cast<float>(options_.max_range)))  // nor is NaN within it
  {
    return -1;
  }
  const int x = static_cast<int>(std::floor(p.x() * cells_per_metre_)) + half_width_;
  const int y = static_cast<int>(std::floor(p.y() * cells_per_metre_)) + half_width_;
  return x < 1 || y < 1 || x >= width_ - 1 || y >= width_ - 1 ? -1 : y * width_ + x;
}

float MovingCells::lowestAround(int cell) const
{
  float lowest = 1e9F;
  for (int row = cell - width_; row <= cell + width_; row += width_)
  {
    lowest = std::min({lowest, at(row - 1).lowest, at(row).lowest, at(row + 1).lowest});
  }
  return lowest;
}

std::vector<std::uint32_t> MovingCells::moving(const std::vector<std::int8_t>& votes)
{
  for (std::size_t i = 0; i < candidates_.size(); ++i)
  {
    Cell& cell = at(candidate_cells_[i]);
    ++cell.points;
    cell.moving += votes[i] > 0 ? 1 : 0;
    cell.voted_static += votes[i] < 0 ? 1 : 0;
  }
  std::vector<int> object_of(cells_.size(), -1);
  const int objects = labelComponents(
      width_,
      [&](int cell) { return at(cell).moving > 0 && at(cell).moving > at(cell).voted_static; },
      object_of);
  std::vector<int> point_count(static_cast<std::size_t>(objects), 0);
  std::vector<int> moving_count(static_cast<std::size_t>(objects), 0);
  for (std::size_t i = 0; i < cells_.size(); ++i)
  {
    if (object_of[i] >= 0)
    {
      point_count[static_cast<std::size_t>(object_of[i])] += cells_[i].points;
      moving_count[static_cast<std::size_t>(object_of[i])] += cells_[i].moving;
    }
  }
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < candidates_.size(); ++i)
  {
    const int object = object_of[static_cast<std::size_t>(candidate_cells_[i])];
    if (object < 0)
    {
      continue;
    }
    const auto o = static_cast<std::size_t>(object);
    if (moving_count[o] >= options_.min_points &&
        moving_count[o] >= options_.min_share * point_count[o])
    {
      result.push_back(candidates_[i]);
    }
  }
  return result;
}
}  // namespace dyslam
