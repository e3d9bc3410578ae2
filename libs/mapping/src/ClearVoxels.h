// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <cstddef>
#include <cstdint>

namespace dyslam
{
class StateArchive;

/** Voxels (odometry frame, by their voxelKey()) that other scans observed, and none of them as
 * free. The result is reused for the next scans, which nearly the same rays decide. */
class ClearVoxels
{
 public:
  /** Begins a scan: forgets voxels that were added 6 to 10 scans before, up to 14 where numbers are
   * left out. \param scan number of the scan, ascending */
  void beginScan(std::size_t scan);
  [[nodiscard]] bool contain(std::uint64_t key) const
  {
    return recent_.find(key) != VoxelHash::none || older_.find(key) != VoxelHash::none;
  }
  void add(std::uint64_t key) { recent_.findOrInsert(key, 0); }
  void exchangeState(StateArchive& archive);

 private:
  std::size_t begin_ = 0;  //!< number of the scan from which on voxels were added to `recent_`
  VoxelHash recent_;
  VoxelHash older_;
};
}  // namespace dyslam
