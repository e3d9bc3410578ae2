// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace dyslam
{
/** Joins those cells of a grid that `belongs` tells with their neighbours, all eight of them.
 *
 * \param group of each cell, row by row, all -1; becomes the number of its group, from 0
 * \param belongs of a cell's place; never true on the grid's rim
 * \return how many groups there are. */
template <typename Belongs>
int joinNeighbours(int width, const Belongs& belongs, std::vector<int>& group)
{
  const auto of = [&](int cell) -> int& { return group[static_cast<std::size_t>(cell)]; };
  const int cells = static_cast<int>(group.size());
  int groups = 0;
  std::vector<int> open;
  for (int seed = 0; seed < cells; ++seed)
  {
    if (of(seed) >= 0 || !belongs(seed))
    {
      continue;
    }
    of(seed) = groups;
    open.assign(1, seed);
    while (!open.empty())
    {
      const int cell = open.back();
      open.pop_back();
      for (const int row : {cell - width, cell, cell + width})
      {
        for (const int next : {row - 1, row, row + 1})
        {
          if (of(next) < 0 && belongs(next))
          {
            of(next) = groups;
            open.push_back(next);
          }
        }
      }
    }
    ++groups;
  }
  return groups;
}
}  // namespace dyslam
