// SPDX-License-Identifier: BSD-3-Clause
#include "MovingGroups.h"

#include <algorithm>
#include <cmath>

#include "CellGroups.h"

namespace dyslam
{
namespace
{
constexpr double margin = 1.6;  // m, so that nothing that is looked at lies on the grid's rim
constexpr float called_over = 0.5F;
constexpr float taken_back = 0.4F;
constexpr float flat = 0.35F;  // m; a patch of three by three cells that spans less is ground

struct Cell
{
  int called = 0;
  int doubtful = 0;
  float low = 1e9F;
  float high = -1e9F;
};

/** Where the points of a group are, an earlier scan saw this. */
struct PastViews
{
  int free = 0;
  int occupied = 0;

  void add(SeenBefore seen)
  {
    free += seen == SeenBefore::free ? 1 : 0;
    occupied += seen == SeenBefore::occupied ? 1 : 0;
  }
  /** What moves has left places behind and taken up free ones, if only with its front. */
  [[nodiscard]] bool stoodThere(int points) const
  {
    constexpr float most_free = 0.05F;
    constexpr float least_occupied = 0.6F;
    return static_cast<float>(free) <= most_free * static_cast<float>(free + occupied) &&
           static_cast<float>(occupied) >= least_occupied * static_cast<float>(points);
  }
};

/** Most of what is doubtful in the cell is called moving, and it is not flat ground. */
bool moves(const std::vector<Cell>& cells, int width, int cell)
{
  const auto at = [&](int i) -> const Cell& { return cells[static_cast<std::size_t>(i)]; };
  if (at(cell).called == 0 || 2 * at(cell).called <= at(cell).doubtful)
  {
    return false;
  }
  float low = at(cell).low;
  float high = at(cell).high;
  for (const int row : {cell - width, cell, cell + width})
  {
    for (const int next : {row - 1, row, row + 1})
    {
      low = std::min(low, at(next).low);
      high = std::max(high, at(next).high);
    }
  }
  return high - low > flat;
}
}  // namespace

void keepMovingGroups(const std::vector<Eigen::Vector3f>& points,
                      const std::vector<SeenBefore>& seen,
                      const MovingGroupsOptions& options,
                      std::vector<float>& probability)
{
  const double cell_size = options.cell_size;
  const double reach = options.reach + margin;
  const int width = 2 * static_cast<int>(std::ceil(reach / cell_size)) + 1;
  std::vector<Cell> cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(width));
  std::vector<int> cell_of(points.size(), -1);
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
    Cell& cell = cells[static_cast<std::size_t>(y * width + x)];
    cell.low = std::min(cell.low, points[i].z());
    cell.high = std::max(cell.high, points[i].z());
    if (!(probability[i] > 0))
    {
      continue;
    }
    cell_of[i] = y * width + x;
    ++cell.doubtful;
    cell.called += probability[i] > called_over ? 1 : 0;
  }
  std::vector<int> group_of(cells.size(), -1);
  const int groups = joinNeighbours(
      width, [&](int cell) { return moves(cells, width, cell); }, group_of);
  std::vector<int> sizes(static_cast<std::size_t>(groups), 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    if (group_of[i] >= 0)
    {
      sizes[static_cast<std::size_t>(group_of[i])] += cells[i].called;
    }
  }
  std::vector<PastViews> views(sizes.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const int group = cell_of[i] < 0 ? -1 : group_of[static_cast<std::size_t>(cell_of[i])];
    if (group >= 0 && probability[i] > called_over)
    {
      views[static_cast<std::size_t>(group)].add(seen[i]);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (cell_of[i] < 0)
    {
      continue;
    }
    const int group = group_of[static_cast<std::size_t>(cell_of[i])];
    if (group < 0 || sizes[static_cast<std::size_t>(group)] < options.min_points ||
        views[static_cast<std::size_t>(group)].stoodThere(sizes[static_cast<std::size_t>(group)]))
    {
      probability[i] = std::min(probability[i], taken_back);
    }
  }
}
}  // namespace dyslam
