// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace dyslam
{
/** Union-find over the numbers from 0; a set is named by its smallest member. */
class DisjointSets
{
 public:
  /** `count` sets with one number each. */
  explicit DisjointSets(std::size_t count) : parent_(count)
  {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  /** Smallest member of the set that contains `i`. */
  std::size_t find(std::size_t i)
  {
    while (parent_[i] != i)
    {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  void join(std::size_t a, std::size_t b)
  {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};
}  // namespace dyslam
