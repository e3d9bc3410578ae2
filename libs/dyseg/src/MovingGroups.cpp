// SPDX-License-Identifier: BSD-3-Clause
#include "MovingGroups.h"

#include <algorithm>
#include <cmath>

#include "ConnectedComponents.h"

namespace dyslam
{
namespace
{
constexpr double margin = 1.6;  // keeps candidates off the grid's border [m]
constexpr float moving_threshold = 0.5F;
constexpr float rejected_probability = 0.4F;
constexpr float min_height = 0.35F;  // least height range of 3 x 3 cells that are not ground [m]

struct Cell
{
  int moving = 0;
  int candidates = 0;
  float low = 1e9F;
  float high = -1e9F;
};

/** Bird's-eye-view grid with the cell of each candidate point. */
struct CandidateGrid
{
  int width = 0;
  std::vector<Cell> cells;
  std::vector<int> cell_of_point;  //!< -1 for points that are no candidates
};

CandidateGrid makeGrid(const std::vector<Eigen::Vector3f>& points,
                       const std::vector<float>& probability,
                       const MovingGroupsOptions& options)
{
  const double cell_size = options.cell_size;
  const double reach = options.reach + margin;
  CandidateGrid grid;
  grid.width = 2 * static_cast<int>(std::ceil(reach / cell_size)) + 1;
  const int width = grid.width;
  grid.cells.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(width));
  grid.cell_of_point.assign(points.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!points[i].allFinite())
    {
      continue;
    }
    const int x = static_cast<int>(std::floor((points[i].x() + reach) / cell_size));
    const int y = static_cast<int>(std::floor((points[i].y() + reach) / cell_size));
    if (x < 1 || y < 1 || x >= width - 1 || y >= width - 1)
    {
      continue;
    }
    Cell& cell = grid.cells[static_cast<std::size_t>(y * width + x)];
    cell.low = std::min(cell.low, points[i].z());
    cell.high = std::max(cell.high, points[i].z());
    if (!(probability[i] > 0))
    {
      continue;
    }
    grid.cell_of_point[i] = y * width + x;
    ++cell.candidates;
    cell.moving += probability[i] > moving_threshold ? 1 : 0;
  }
  return grid;
}

/** Whether most candidates of a cell are moving and the cell is not flat ground. */
bool isMoving(const CandidateGrid& grid, int cell)
{
  const auto at = [&](int i) -> const Cell& { return grid.cells[static_cast<std::size_t>(i)]; };
  if (at(cell).moving == 0 || 2 * at(cell).moving <= at(cell).candidates)
  {
    return false;
  }
  float low = at(cell).low;
  float high = at(cell).high;
  for (const int row : {cell - grid.width, cell, cell + grid.width})
  {
    for (const int next : {row - 1, row, row + 1})
    {
      low = std::min(low, at(next).low);
      high = std::max(high, at(next).high);
    }
  }
  return high - low > min_height;
}

/** A connected component of moving cells. */
struct Group
{
  int points = 0;    //!< number of moving points
  int free = 0;      //!< moving points at positions that the earlier scan observed free
  int occupied = 0;  //!< moving points at positions that the earlier scan observed occupied

  void add(PastVisibility visibility)
  {
    free += visibility == PastVisibility::free ? 1 : 0;
    occupied += visibility == PastVisibility::occupied ? 1 : 0;
  }
  /** Whether a group was already at its position: moving objects cover some formerly free space. */
  [[nodiscard]] bool wasThereBefore() const
  {
    constexpr float max_free_ratio = 0.05F;
    constexpr float min_occupied_ratio = 0.6F;
    return static_cast<float>(free) <= max_free_ratio * static_cast<float>(free + occupied) &&
           static_cast<float>(occupied) >= min_occupied_ratio * static_cast<float>(points);
  }
};
}  // namespace

void keepMovingGroups(const std::vector<Eigen::Vector3f>& points,
                      const std::vector<PastVisibility>& visibility,
                      const MovingGroupsOptions& options,
                      std::vector<float>& probability)
{
  const CandidateGrid grid = makeGrid(points, probability, options);
  std::vector<int> group_of_cell(grid.cells.size(), -1);
  const int count = labelComponents(
      grid.width, [&](int cell) { return isMoving(grid, cell); }, group_of_cell);
  std::vector<Group> groups(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < grid.cells.size(); ++i)
  {
    if (group_of_cell[i] >= 0)
    {
      groups[static_cast<std::size_t>(group_of_cell[i])].points += grid.cells[i].moving;
    }
  }
  const auto groupOf = [&](std::size_t point) -> Group*
  {
    const int cell = grid.cell_of_point[point];
    const int group = cell < 0 ? -1 : group_of_cell[static_cast<std::size_t>(cell)];
    return group < 0 ? nullptr : &groups[static_cast<std::size_t>(group)];
  };
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    Group* const group = groupOf(i);
    if (group != nullptr && probability[i] > moving_threshold)
    {
      group->add(visibility[i]);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (grid.cell_of_point[i] < 0)
    {
      continue;
    }
    const Group* const group = groupOf(i);
    if (group == nullptr || group->points < options.min_points || group->wasThereBefore())
    {
      probability[i] = std::min(probability[i], rejected_probability);
    }
  }
}
}  // namespace dyslam
