// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Integer cell of a point in a grid of cubes. */
struct VoxelCell
{
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
};

/** A coordinate in units of cells as the number of its cell: rounded down. Coordinates beyond about
 * 2^30 cells, and those that are not finite, are in the last cell. */
template <typename Scalar>
[[nodiscard]] std::int32_t cellNumber(Scalar coordinate)
{
  // Exact as float; its key is that of the outermost cell with a unique key.
  constexpr auto last = static_cast<Scalar>((1 << 30) - (1 << 20));
  const Scalar cell = std::floor(coordinate);
  return static_cast<std::int32_t>(std::abs(cell) < last ? cell : std::copysign(last, cell));
}

/** Cell of `p` in cubes of side 1 / `inverse_size`, see cellNumber(). */
[[nodiscard]] inline VoxelCell voxelCell(const Eigen::Vector3f& p, float inverse_size)
{
  return {cellNumber(p.x() * inverse_size), cellNumber(p.y() * inverse_size),
          cellNumber(p.z() * inverse_size)};
}

/** A cell as one number; unique while every coordinate is within +-2^20. */
[[nodiscard]] inline std::uint64_t voxelKey(const VoxelCell& c)
{
  constexpr std::uint32_t offset = 1U << 20;
  constexpr std::uint64_t mask = (1ULL << 21) - 1;
  const auto pack = [](std::int32_t v)
  { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v) + offset) & mask; };
  return (pack(c.x) << 42) | (pack(c.y) << 21) | pack(c.z);
}

/** Open-addressing hash from voxel keys to 32-bit values. Copyable; not thread-safe for writing. */
class VoxelHash
{
 public:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  explicit VoxelHash(std::size_t expected = 0) { reserve(expected); }

  /** Removes all entries, keeps the memory. */
  void clear();
  /** Makes room for this many entries without rehashing. */
  void reserve(std::size_t expected);
  [[nodiscard]] std::size_t size() const { return size_; }
  void exchangeState(StateArchive& archive);

  /** The value stored under `key`, or `none`. */
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const
  {
    if (slots_.empty())
    {
      return none;
    }
    for (std::size_t i = slotOf(key);; i = (i + 1) & mask_)
    {
      const Slot& slot = slots_[i];
      if (slot.value == none || slot.key == key)
      {
        return slot.value;
      }
    }
  }

  /** The value under `key`; if there is none, `value` is stored and returned. \pre `value` is not
   * `none`. */
  std::uint32_t findOrInsert(std::uint64_t key, std::uint32_t value)
  {
    if ((size_ + 1) * 2 > slots_.size())
    {
      reserve(size_ + 1);
    }
    std::size_t i = slotOf(key);
    for (; slots_[i].value != none; i = (i + 1) & mask_)
    {
      if (slots_[i].key == key)
      {
        return slots_[i].value;
      }
    }
    slots_[i] = {key, value};
    ++size_;
    return value;
  }

 private:
  struct Slot
  {
    std::uint64_t key;
    std::uint32_t value;
  };

  [[nodiscard]] std::size_t slotOf(std::uint64_t key) const
  {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> shift_);
  }

  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  int shift_ = 63;
  std::size_t size_ = 0;
};

enum class VoxelPick
{
  first,    //!< the first input point that fell into the voxel
  centroid  //!< the mean of the voxel's points
};

struct VoxelSample
{
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> index;  //!< position in the input of the first point of each voxel
};

/** One point per occupied voxel, in the order in which voxels are first met; points that are not
 * finite are left out. Deterministic, O(points).
 * \param voxel_size side of the cubes [m], > 0 \throws std::invalid_argument if it is not. */
[[nodiscard]] VoxelSample voxelDownsample(const std::vector<Eigen::Vector3f>& points,
                                          double voxel_size,
                                          VoxelPick pick = VoxelPick::first);
}  // namespace dyslam
