// SPDX-License-Identifier: BSD-3-Clause
#include "GroundHeights.h"

#include <dyslam/core/Quantile.h>
#include <dyslam/core/StateArchive.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace dyslam
{
namespace
{
constexpr float square = 2.0F;             // side [m]
constexpr float fine_square = 0.5F;        // side of the squares within [m]
constexpr float fine_reach = 0.5F;         // above the third lowest return of a square [m]
constexpr std::uint32_t fewest_scans = 3;  // with returns in one of those
constexpr float step = 0.3F;  // of the ground above the median of the squares around, at most [m]
constexpr float nothing = std::numeric_limits<float>::infinity();
constexpr float last_square = (1U << 20U) - 2;  // the neighbours of which have keys of their own

/** Points that are not finite or too far away are in the last square. \param side [m] */
VoxelCell squareOf(const Eigen::Vector3f& p, float side = square)
{
  const auto along = [side](float coordinate)
  {
    const float number = std::floor(coordinate / side);
    return static_cast<std::int32_t>(std::abs(number) < last_square ? number : last_square);
  };
  return {along(p.x()), along(p.y()), 0};
}
}  // namespace

LowestReturns::LowestReturns(const std::vector<Eigen::Vector3f>& points,
                             const Eigen::Isometry3f& T_odom_vehicle)
{
  VoxelHash index;
  std::vector<std::array<float, 3>> lowest;
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> square_of_point;
  square_of_point.reserve(points.size());
  std::uint32_t found = VoxelHash::none;
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3f p = T_odom_vehicle * point;
    const std::uint64_t key = voxelKey(squareOf(p));
    if (found == VoxelHash::none ||
        keys[found] != key)  // most are in the same square as the one before
    {
      found = index.findOrInsert(key, static_cast<std::uint32_t>(keys.size()));
    }
    if (found == keys.size())
    {
      keys.push_back(key);
      lowest.push_back({nothing, nothing, nothing});
    }
    auto& low = lowest[found];
    square_of_point.push_back(found);
    if (p.z() < low[2])
    {
      low[2] = p.z();
      std::sort(low.begin(), low.end());
    }
  }
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    const auto& low = lowest[i];
    heights_.emplace_back(keys[i],
                          low[2] < nothing ? low[2] : (low[1] < nothing ? low[1] : low[0]));
  }
  VoxelHash fine_index;
  std::uint32_t fine_found = VoxelHash::none;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f p = T_odom_vehicle * points[i];
    if (!(p.z() < heights_[square_of_point[i]].second + fine_reach))
    {
      continue;
    }
    const std::uint64_t key = voxelKey(squareOf(p, fine_square));
    if (fine_found == VoxelHash::none || fine_[fine_found].first != key)
    {
      fine_found = fine_index.findOrInsert(key, static_cast<std::uint32_t>(fine_.size()));
    }
    if (fine_found == fine_.size())
    {
      fine_.emplace_back(key, p.z());
    }
    fine_[fine_found].second = std::min(fine_[fine_found].second, p.z());
  }
}

namespace
{
using Heights = std::vector<std::pair<std::uint64_t, float>>;

/** Low quantile of the heights in each square. \param heights of each scan
 * \param[out] index of the squares */
std::vector<float> joinedHeights(const std::vector<const Heights*>& heights_of_scans,
                                 std::uint32_t fewest,
                                 VoxelHash& index)
{
  std::vector<std::uint32_t> squares;  // of the heights, as they come
  std::vector<std::uint32_t> counts;   // of the heights of each square
  for (const Heights* scan : heights_of_scans)
  {
    for (const auto& [key, z] : *scan)
    {
      const auto next = static_cast<std::uint32_t>(counts.size());
      squares.push_back(index.findOrInsert(key, next));
      if (squares.back() == next)
      {
        counts.push_back(0);
      }
      ++counts[squares.back()];
    }
  }
  std::vector<std::uint32_t> ends(counts.size());  // of the heights so far, square by square
  std::exclusive_scan(counts.begin(), counts.end(), ends.begin(), 0U);
  std::vector<float> heights(squares.size());
  std::size_t i = 0;
  for (const Heights* scan : heights_of_scans)
  {
    for (const auto& [key, z] : *scan)
    {
      heights[ends[squares[i++]]++] = z;
    }
  }
  std::vector<float> result;
  result.reserve(counts.size());
  for (std::size_t s = 0; s < counts.size(); ++s)
  {
    const auto end = heights.begin() + ends[s];
    result.push_back(counts[s] < fewest ? -nothing : lowQuantile(end - counts[s], end, 4));
  }
  return result;
}
}  // namespace

GroundHeights::GroundHeights(const std::vector<const LowestReturns*>& scans)
{
  std::vector<const Heights*> heights;
  std::vector<const Heights*> fine;
  for (const LowestReturns* scan : scans)
  {
    heights.push_back(&scan->heights());
    fine.push_back(&scan->fineHeights());
  }
  height_ = joinedHeights(heights, 1, index_);
  fine_height_ = joinedHeights(fine, fewest_scans, fine_index_);
}

float GroundHeights::fineHeightOf(const Eigen::Vector3f& p, float height) const
{
  const std::uint32_t found = fine_index_.find(voxelKey(squareOf(p, fine_square)));
  return found == VoxelHash::none ? height : std::min(height, p.z() - fine_height_[found]);
}

std::vector<float> GroundHeights::heightsOf(const std::vector<Eigen::Vector3f>& points) const
{
  std::vector<float> heights;
  heights.reserve(points.size());
  std::vector<float> ground(height_.size(), nothing);
  std::optional<std::uint64_t> last;  // most points are in the same square as the one before
  std::uint32_t found = VoxelHash::none;
  for (const Eigen::Vector3f& p : points)
  {
    const VoxelCell square = squareOf(p);
    const std::uint64_t key = voxelKey(square);
    if (key != last)
    {
      last = key;
      found = index_.find(key);
      if (found != VoxelHash::none && ground[found] == nothing)
      {
        ground[found] = limited(square, height_[found]);
      }
    }
    heights.push_back(p.z() - (found != VoxelHash::none ? ground[found] : limited(square, p.z())));
  }
  return heights;
}

float GroundHeights::limited(const VoxelCell& square, float own) const
{
  std::array<float, 9> around{};
  std::size_t count = 0;
  for (int dx = -1; dx <= 1; ++dx)
  {
    for (int dy = -1; dy <= 1; ++dy)
    {
      const std::uint32_t found = index_.find(voxelKey({square.x + dx, square.y + dy, 0}));
      if (found != VoxelHash::none)
      {
        around[count++] = height_[found];
      }
    }
  }
  const auto end = around.begin() + static_cast<std::ptrdiff_t>(count);
  return count == 0 ? own : std::min(own, upperMedian(around.begin(), end) + step);
}

void LowestReturns::exchangeState(StateArchive& archive)
{
  archive(heights_, fine_);
}
}  // namespace dyslam
