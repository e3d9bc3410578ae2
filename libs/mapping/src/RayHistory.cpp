// SPDX-License-Identifier: BSD-3-Clause
#include "RayHistory.h"

#include <algorithm>
#include <array>

namespace dyslam
{
namespace
{
constexpr std::size_t chunk = 256;  // of places in a thread

/** Scans before or those after, from the nearest in time to the farthest. */
struct Side
{
  std::int16_t sum = 0;  //!< of those that observed the place free, less `weight` times the others
  std::int16_t lowest = 0;

  /** \return the largest sum of the farthest ones. */
  std::uint16_t add(bool free)
  {
    constexpr std::int16_t weight = 2;
    sum = static_cast<std::int16_t>(free ? sum + 1 : sum - weight);
    lowest = std::min(lowest, sum);
    return static_cast<std::uint16_t>(sum - lowest);
  }
};

struct Sides
{
  Side before;
  Side after;
};

void add(const OtherScan& other, Evidence seen, RayCounts& c, Sides& sides)
{
  const bool free = seen == Evidence::free || seen == Evidence::enclosed;
  if (!free && seen != Evidence::occupied)
  {
    return;
  }
  ++(free ? c.free : c.occupied);
  if (other.after)
  {
    c.change_after = sides.after.add(free);
  }
  else
  {
    c.change_before = sides.before.add(free);
  }
}
}  // namespace

std::vector<RayCounts> countRays(const std::vector<OtherScan>& others,
                                 const std::vector<Eigen::Vector3f>& places,
                                 float size,
                                 float margin,
                                 ThreadPool& pool)
{
  std::vector<RayCounts> counts(places.size());
  pool.forChunks(counts.size(), chunk,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   std::array<Evidence, chunk> seen;
                   std::array<Sides, chunk> sides{};
                   for (const OtherScan& other : others)
                   {
                     other.image->at(&places[begin], end - begin, other.T_other_this, size, margin,
                                     seen.data());
                     for (std::size_t g = begin; g < end; ++g)
                     {
                       add(other, seen[g - begin], counts[g], sides[g - begin]);
                     }
                   }
                 });
  return counts;
}
}  // namespace dyslam
