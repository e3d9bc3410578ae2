// SPDX-License-Identifier: BSD-3-Clause
#include "MovingCells.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dyslam
{
namespace
{
struct Cell
{
  float lowest = 1e9F;
  int points = 0;  //!< above ground
  int moving = 0;
  int still = 0;
  int object = -1;
};

/** A square grid around the vehicle. */
class Grid
{
 public:
  Grid(double reach, double cell_size)
      : inverse_(static_cast<float>(1 / cell_size)),
        half_(static_cast<int>(std::ceil(reach / cell_size)) + 1),
        width_(2 * half_ + 1),
        cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_))
  {
  }
  /** Index of the cell above which a point lies; -1 outside. */
  [[nodiscard]] int indexOf(const Eigen::Vector3f& p) const
  {
    const int x = static_cast<int>(std::floor(p.x() * inverse_)) + half_;
    const int y = static_cast<int>(std::floor(p.y() * inverse_)) + half_;
    return x < 1 || y < 1 || x >= width_ - 1 || y >= width_ - 1 ? -1 : y * width_ + x;
  }
  [[nodiscard]] Cell& operator[](int i) { return cells_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Cell& operator[](int i) const { return cells_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int size() const { return static_cast<int>(cells_.size()); }

 private:
  float inverse_;
  int half_;
  int width_;
  std::vector<Cell> cells_;
};

float lowestAround(const Grid& grid, int cell)
{
  float lowest = 1e9F;
  for (int dy = -1; dy <= 1; ++dy)
  {
    for (int dx = -1; dx <= 1; ++dx)
    {
      lowest = std::min(lowest, grid[cell + dy * grid.width() + dx].lowest);
    }
  }
  return lowest;
}

bool isMovingCell(const Cell& cell)
{
  return cell.moving > 0 && cell.moving > cell.still;
}

/** Gives every connected set of moving cells a number; returns how many there are. */
int labelObjects(Grid& grid)
{
  int objects = 0;
  std::vector<int> open;
  for (int seed = grid.width() + 1; seed < grid.size() - grid.width() - 1; ++seed)
  {
    if (grid[seed].object >= 0 || !isMovingCell(grid[seed]))
    {
      continue;
    }
    grid[seed].object = objects;
    open.assign(1, seed);
    while (!open.empty())
    {
      const int cell = open.back();
      open.pop_back();
      for (const int step : {-grid.width() - 1, -grid.width(), -grid.width() + 1, -1, 1,
                             grid.width() - 1, grid.width(), grid.width() + 1})
      {
        const int next = cell + step;
        if (next >= 0 && next < grid.size() && grid[next].object < 0 && isMovingCell(grid[next]))
        {
          grid[next].object = objects;
          open.push_back(next);
        }
      }
    }
    ++objects;
  }
  return objects;
}
}  // namespace

std::vector<bool> movingCells(const std::vector<Eigen::Vector3f>& points,
                              const std::vector<std::int8_t>& votes,
                              const ResidualSegmenterOptions& options)
{
  Grid grid(options.max_range, options.cell_size);
  std::vector<int> cell_of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    cell_of[i] = grid.indexOf(points[i]);
    if (cell_of[i] >= 0)
    {
      grid[cell_of[i]].lowest = std::min(grid[cell_of[i]].lowest, points[i].z());
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const int at = cell_of[i];
    if (at < 0)
    {
      continue;
    }
    if (points[i].z() < lowestAround(grid, at) + static_cast<float>(options.ground_clearance))
    {
      cell_of[i] = -1;
      continue;
    }
    Cell& cell = grid[at];
    ++cell.points;
    cell.moving += votes[i] > 0 ? 1 : 0;
    cell.still += votes[i] < 0 ? 1 : 0;
  }

  struct Tally
  {
    int points = 0;
    int moving = 0;
  };
  std::vector<Tally> tallies(static_cast<std::size_t>(labelObjects(grid)));
  for (int i = 0; i < grid.size(); ++i)
  {
    if (grid[i].object >= 0)
    {
      tallies[static_cast<std::size_t>(grid[i].object)].points += grid[i].points;
      tallies[static_cast<std::size_t>(grid[i].object)].moving += grid[i].moving;
    }
  }
  std::vector<bool> moving(points.size(), false);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const int object = cell_of[i] < 0 ? -1 : grid[cell_of[i]].object;
    if (object >= 0)
    {
      const Tally& tally = tallies[static_cast<std::size_t>(object)];
      moving[i] =
          tally.moving >= options.min_points && tally.moving >= options.min_share * tally.points;
    }
  }
  return moving;
}
}  // namespace dyslam
