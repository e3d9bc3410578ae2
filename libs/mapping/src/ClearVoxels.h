// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <cstddef>
#include <cstdint>

#include "Generations.h"

namespace dyslam
{
/** Voxels (odometry frame, by their voxelKey()) that other scans observed, and none of them as
 * free. The result is reused for the next scans, which nearly the same rays decide. */
class ClearVoxels
{
 public:
  /** Begins a scan: forgets voxels that were added 6 to 10 scans before, up to 14 where numbers are
   * left out. \param scan number of the scan, ascending */
  void beginScan(std::size_t scan) { voxels_.beginScan(scan); }
  [[nodiscard]] bool contain(std::uint64_t key) const
  {
    return voxels_.recent().find(key) != VoxelHash::none ||
           voxels_.older().find(key) != VoxelHash::none;
  }
  void add(std::uint64_t key) { voxels_.recent().findOrInsert(key, 0); }
  void exchangeState(StateArchive& archive) { archive(voxels_); }

 private:
  static constexpr std::size_t period = 5;  //!< of the generations [scans]

  Generations<VoxelHash> voxels_{period};
};
}  // namespace dyslam
