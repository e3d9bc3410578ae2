// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <stdexcept>

namespace dyslam
{
void VoxelHash::clear()
{
  std::fill(slots_.begin(), slots_.end(), Slot{0, none});
  size_ = 0;
}

void VoxelHash::reserve(std::size_t expected)
{
  // At most half full, and twice the present need, so that growing is amortised.
  std::size_t capacity = 16;
  int bits = 4;
  while (capacity < expected * 2)
  {
    capacity *= 2;
    ++bits;
  }
  if (capacity <= slots_.size())
  {
    return;
  }
  std::vector<Slot> old = std::move(slots_);
  slots_.assign(capacity, Slot{0, none});
  mask_ = capacity - 1;
  shift_ = 64 - bits;
  for (const Slot& slot : old)
  {
    if (slot.value == none)
    {
      continue;
    }
    std::size_t i = slotOf(slot.key);
    while (slots_[i].value != none)
    {
      i = (i + 1) & mask_;
    }
    slots_[i] = slot;
  }
}

VoxelSample voxelDownsample(const std::vector<Eigen::Vector3f>& points,
                            double voxel_size,
                            VoxelPick pick)
{
  if (!(voxel_size > 0))
  {
    throw std::invalid_argument("voxelDownsample: voxel_size must be positive");
  }
  const auto inverse = static_cast<float>(1.0 / voxel_size);
  VoxelSample sample;
  VoxelHash hash(points.size() / 4);
  std::vector<Eigen::Vector3f> sums;
  std::vector<std::uint32_t> counts;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f& p = points[i];
    if (!p.allFinite())
    {
      continue;
    }
    const auto next = static_cast<std::uint32_t>(sample.index.size());
    const std::uint32_t slot = hash.findOrInsert(voxelKey(voxelCell(p, inverse)), next);
    if (slot == next)
    {
      sample.points.push_back(p);
      sample.index.push_back(static_cast<std::uint32_t>(i));
      if (pick == VoxelPick::centroid)
      {
        sums.push_back(Eigen::Vector3f::Zero());
        counts.push_back(1);
      }
    }
    else if (pick == VoxelPick::centroid)
    {
      // Offsets from the voxel's first point keep float precision far from the origin.
      sums[slot] += p - sample.points[slot];
      ++counts[slot];
    }
  }
  for (std::size_t v = 0; v < sums.size(); ++v)
  {
    sample.points[v] += sums[v] / static_cast<float>(counts[v]);
  }
  return sample;
}

void VoxelHash::exchangeState(StateArchive& archive)
{
  archive(slots_, mask_, shift_, size_);
}
}  // namespace dyslam
