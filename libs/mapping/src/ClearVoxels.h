// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <cstddef>
#include <cstdint>

namespace dyslam
{
class StateArchive;

/** Voxels (in the odometry frame, by their voxelKey()) that other scans observed, and never free.
 * They stay known for the next scans, for which nearly the same rays decide. */
class ClearVoxels
{
 public:
  /** \param scan number, ascending. Forgets what was found 6 to 10 scans before; up to 14 where
   * numbers are left out. */
  void beginScan(std::size_t scan);
  [[nodiscard]] bool contain(std::uint64_t key) const
  {
    return recent_.find(key) != VoxelHash::none || older_.find(key) != VoxelHash::none;
  }
  void add(std::uint64_t key) { recent_.findOrInsert(key, 0); }
  void exchangeState(StateArchive& archive);

 private:
  std::size_t begin_ = 0;  //!< scan with the first of `recent_`
  VoxelHash recent_;
  VoxelHash older_;
};
}  // namespace dyslam
