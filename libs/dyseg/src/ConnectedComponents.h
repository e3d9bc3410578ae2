// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace dyslam
{
/** Connected components (8-neighbourhood) of the foreground cells of a grid.
 *
 * \param width width of the grid [cells]
 * \param foreground predicate on a cell's index; must be false on the border of the grid
 * \param label one value per cell, row by row, all -1; set to the index of its component, from 0
 * \return the number of components. */
template <typename Foreground>
int labelComponents(int width, const Foreground& foreground, std::vector<int>& label)
{
  const auto labelOf = [&](int cell) -> int& { return label[static_cast<std::size_t>(cell)]; };
  const int cells = static_cast<int>(label.size());
  int components = 0;
  std::vector<int> open;
  for (int seed = 0; seed < cells; ++seed)
  {
    if (labelOf(seed) >= 0 || !foreground(seed))
    {
      continue;
    }
    labelOf(seed) = components;
    open.assign(1, seed);
    while (!open.empty())
    {
      const int cell = open.back();
      open.pop_back();
      for (const int row : {cell - width, cell, cell + width})
      {
        for (const int next : {row - 1, row, row + 1})
        {
          if (labelOf(next) < 0 && foreground(next))
          {
            labelOf(next) = components;
            open.push_back(next);
          }
        }
      }
    }
    ++components;
  }
  return components;
}
}  // namespace dyslam
