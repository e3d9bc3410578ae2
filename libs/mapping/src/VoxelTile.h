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
  std::array<float, 3> corner_offset{};  //!< sum over points, from the cell's corner [m]
  float intensity = 0;                   //!< sum over points
  VoxelCell cell;
  std::uint32_t number = 0;                   //!< in the order in which voxels were first met
  std::uint32_t last_keyframe = 0xFFFFFFFFU;  //!< that hit it
  std::uint16_t points = 0;                   //!< kept with their keyframes
  std::uint16_t hits = 0;                     //!< keyframes that hit it
  std::uint16_t old_hits = 0;       //!< in the map before the last correction, of the points in it
  std::uint16_t observed_free = 0;  //!< keyframes that observed it as free
  bool has_evidence = false;        //!< carried over from the map before the last correction
  std::uint8_t discounted_in = 0;   //!< the last run that discounted what earlier runs observed
  std::uint8_t old_discounted_in = 0;  //!< of the voxels that old_hits are of
  std::uint8_t last_lidar = 0;         //!< of last_keyframe, that hit it: KeyframeCloud::lidar
};

/** The voxels of a square of the map; a value of SwappedStore. */
class VoxelTile
{
 public:
  /** Position in voxels(); VoxelHash::none if there is none. */
  [[nodiscard]] std::uint32_t find(const VoxelCell& cell) const
  {
    return slots_.empty() ? VoxelHash::none : slots_[slotOf(cell)];
  }
  /** Adds a voxel of a cell that has none. */
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
  /** Where the voxel of a cell is listed, or would be. */
  [[nodiscard]] std::size_t slotOf(const VoxelCell& cell) const;
  /** Makes room for this many voxels. */
  void index(std::size_t voxels);

  std::vector<Voxel> voxels_;
  std::vector<std::uint32_t> slots_;  //!< open addressing; a power of two of them, half free
};
}  // namespace dyslam
