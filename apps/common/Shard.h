// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** One of several equal parts of a list, for as many machines: every count-th entry. */
struct Shard
{
  std::size_t number = 1;  //!< 1 to count
  std::size_t count = 1;

  /** \param text as `3/20` \throws UserError. */
  [[nodiscard]] static Shard fromText(const std::string& text);

  template <typename T>
  [[nodiscard]] std::vector<T> of(const std::vector<T>& all) const
  {
    std::vector<T> part;
    for (std::size_t i = number - 1; i < all.size(); i += count)
    {
      part.push_back(all[i]);
    }
    return part;
  }
};
}  // namespace dyslam
