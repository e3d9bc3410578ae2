// SPDX-License-Identifier: BSD-3-Clause
#include "RayHistory.h"

#include <algorithm>

namespace dyslam
{
namespace
{
constexpr std::size_t chunk = 256;       // number of voxels that a thread evaluates at once
constexpr std::size_t probe_stride = 3;  // step of the scans evaluated first; odd: both sides
constexpr int sufficient_scans = 6;      // least number of scans that observed a clear voxel

/** Running sum over the earlier or the later scans, which are added from the nearest in time to the
 * farthest: +1 for a scan that observed the voxel free, -2 for one that observed it occupied. */
struct Side
{
  std::int16_t sum = 0;
  std::int16_t lowest = 0;  //!< lowest sum so far

  /** Adds a scan. \return largest sum over the scans from some moment up to this one:
   * RayCounts::change_before or change_after */
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

/** What the other scans observed at the voxels of a chunk. */
class ChunkEvidence
{
 public:
  ChunkEvidence(const std::vector<OtherScan>& others,
                const Eigen::Vector3f* voxels,
                std::size_t count,
                float size,
                float margin)
      : others_(others), voxels_(voxels), count_(count), size_(size), margin_(margin)
  {
    seen_.resize(others.size() * count, Evidence::none);
  }

  [[nodiscard]] static bool isProbe(std::size_t other) { return other % probe_stride == 0; }

  /** Evaluates every third scan at all voxels. */
  void probe()
  {
    for (std::size_t o = 0; o < others_.size(); ++o)
    {
      if (isProbe(o))
      {
        others_[o].rays->evaluate(voxels_, count_, others_[o].T_other_this, size_, margin_, row(o));
      }
    }
  }

  /** Evaluates the remaining scans. \param chosen voxels at which they are evaluated */
  void complete(const std::vector<std::size_t>& chosen)
  {
    std::vector<Eigen::Vector3f> voxels;
    for (const std::size_t i : chosen)
    {
      voxels.push_back(voxels_[i]);
    }
    std::vector<Evidence> seen(voxels.size());
    for (std::size_t o = 0; o < others_.size(); ++o)
    {
      if (!isProbe(o))
      {
        others_[o].rays->evaluate(voxels.data(), voxels.size(), others_[o].T_other_this, size_,
                                  margin_, seen.data());
        for (std::size_t k = 0; k < chosen.size(); ++k)
        {
          row(o)[chosen[k]] = seen[k];
        }
      }
    }
  }

  [[nodiscard]] RayCounts countsOf(std::size_t voxel)
  {
    RayCounts counts;
    Sides sides;
    for (std::size_t o = 0; o < others_.size(); ++o)
    {
      add(others_[o], row(o)[voxel], counts, sides);
    }
    return counts;
  }

 private:
  Evidence* row(std::size_t other) { return &seen_[other * count_]; }

  const std::vector<OtherScan>& others_;
  const Eigen::Vector3f* voxels_;
  std::size_t count_;
  float size_, margin_;
  std::vector<Evidence> seen_;  //!< evidence at all voxels, scan after scan
};
}  // namespace

bool isClear(const RayCounts& counts)
{
  return counts.free == 0 && counts.occupied >= sufficient_scans;
}

std::vector<RayCounts> countRays(const std::vector<OtherScan>& others,
                                 const std::vector<Eigen::Vector3f>& voxels,
                                 const std::vector<RayEffort>& efforts,
                                 float size,
                                 float margin,
                                 ThreadPool& pool)
{
  std::vector<RayCounts> counts(voxels.size());
  pool.forChunks(counts.size(), chunk,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   ChunkEvidence evidence(others, &voxels[begin], end - begin, size, margin);
                   evidence.probe();
                   std::vector<std::size_t> doubtful;
                   for (std::size_t g = begin; g < end; ++g)
                   {
                     counts[g] = evidence.countsOf(g - begin);
                     if (efforts[g] == RayEffort::all ||
                         (efforts[g] == RayEffort::if_needed && !isClear(counts[g])))
                     {
                       doubtful.push_back(g - begin);
                     }
                   }
                   evidence.complete(doubtful);
                   for (const std::size_t i : doubtful)
                   {
                     counts[begin + i] = evidence.countsOf(i);
                   }
                 });
  return counts;
}
}  // namespace dyslam
