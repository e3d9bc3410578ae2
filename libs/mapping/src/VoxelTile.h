// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
struct Voxel
{
  std::array<float, 3> corner_offset{};  //!< sum of the points' offsets from the cell's corner [m]
  float intensity = 0;                   //!< sum of the points' intensities
  VoxelCell cell;
  std::uint32_t number = 0;  //!< number in the order in which voxels were first hit
  std::uint32_t last_keyframe = 0xFFFFFFFFU;  //!< last keyframe that hit the voxel
  std::uint16_t points = 0;                   //!< number of points kept in their keyframes
  std::uint16_t hits = 0;                     //!< number of keyframes that hit the voxel
  std::uint16_t old_hits = 0;       //!< most hits of its points' voxels before the last correction
  std::uint16_t observed_free = 0;  //!< number of keyframes that observed it as free
  bool has_evidence = false;        //!< evidence was carried over from before the last correction
  std::uint8_t discounted_in = 0;   //!< last run that discounted what earlier runs observed
  std::uint8_t old_discounted_in = 0;  //!< latest discounted_in of those old voxels
  std::uint8_t last_lidar = 0;         //!< lidar of last_keyframe that hit it: KeyframeCloud::lidar
};

/** The voxels of a square of the map; a value of SwappedStore. */
class VoxelTile
{
 public:
  /** Index of a cell's voxel in voxels(); VoxelHash::none if it has none. */
  [[nodiscard]] std::uint32_t find(const VoxelCell& cell) const
  {
    return slots_.empty() ? VoxelHash::none : slots_[slotOf(cell)];
  }
  /** Adds the voxel of a cell. \pre find(cell) is none */
  Voxel& add(const VoxelCell& cell);

  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }
  [[nodiscard]] std::vector<Voxel>& voxels() { return voxels_; }

  [[nodiscard]] std::size_t memory() const
  {
    return voxels_.capacity() * sizeof(Voxel) + slots_.capacity() * sizeof slots_[0];
  }
  [[nodiscard]] std::string toBytes() const;
  [[nodiscard]] static VoxelTile fromBytes(std::string_view bytes);

 private:
  /** Index in slots_ where the voxel of a cell is listed, or would be. */
  [[nodiscard]] std::size_t slotOf(const VoxelCell& cell) const;
  /** Enlarges slots_ if this many voxels need it. */
  void index(std::size_t voxels);

  std::vector<Voxel> voxels_;
  std::vector<std::uint32_t> slots_;  //!< open-addressing hash table of a power of two, half free
};
}  // namespace dyslam
