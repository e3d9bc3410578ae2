// SPDX-License-Identifier: BSD-3-Clause
#include "JoinedGround.h"

#include <dyslam/base/Quantile.h>

#include <limits>
#include <numeric>

namespace dyslam
{
std::uint32_t NumberedSquares::add(const VoxelCell& square)
{
  const std::uint64_t key = voxelKey(square);
  if (key != last_key_)  // most points are in the same square as the one before
  {
    last_key_ = key;
    last_ = index_.findOrInsert(key, static_cast<std::uint32_t>(keys_.size()));
    if (last_ == keys_.size())
    {
      keys_.push_back(key);
      squares_.push_back(square);
    }
  }
  return last_;
}

std::vector<float> joinGround(const std::vector<const SquareHeights*>& scans,
                              const NumberedSquares& squares,
                              std::uint32_t fewest)
{
  constexpr std::size_t parts = 4;
  std::vector<std::pair<std::uint32_t, float>> found;  // number of the square, height
  std::vector<std::uint32_t> counts(squares.size());   // number of heights per square
  for (const SquareHeights* scan : scans)
  {
    for (const auto& [key, z] : *scan)
    {
      const std::uint32_t square = squares.find(key);
      if (square != VoxelHash::none)
      {
        found.emplace_back(square, z);
        ++counts[square];
      }
    }
  }
  std::vector<std::uint32_t> ends(counts.size());  // end of each square's heights in `heights`
  std::exclusive_scan(counts.begin(), counts.end(), ends.begin(), 0U);
  std::vector<float> heights(found.size());
  for (const auto& [square, z] : found)
  {
    heights[ends[square]++] = z;
  }
  std::vector<float> result(counts.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t s = 0; s < counts.size(); ++s)
  {
    if (counts[s] >= fewest)
    {
      const auto end = heights.begin() + ends[s];
      result[s] = lowQuantile(end - counts[s], end, parts);
    }
  }
  return result;
}
}  // namespace dyslam
