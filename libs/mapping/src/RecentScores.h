// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Scores of the voxels of the last scans, to smooth the scores of the next scan over time. The ray
 * evidence of static voxels hardly changes from scan to scan, but their segment and their causal
 * label may differ for one scan. */
class RecentScores
{
 public:
  /** Begins a scan: forgets scores older than those of the two scans before. \param scan number of
   * the scan, ascending */
  void beginScan(std::size_t scan);
  /** Smooths the score of a voxel: the mean with the smoothed score of the same voxel in one of the
   * two scans before, if it has one and the new score is not certain. Remembers the result. \param
   * key voxelKey() of the voxel, see Segments::key_of_voxel \param score log odds that the voxel
   * moves \return the smoothed score */
  [[nodiscard]] float smooth(std::uint64_t key, float score);
  void exchangeState(StateArchive& archive);

 private:
  struct OfScan
  {
    std::size_t scan = 0;
    VoxelHash index;  //!< from the keys of voxels to positions in `scores`
    std::vector<float> scores;

    void exchangeState(StateArchive& archive);
  };
  OfScan current_;
  OfScan before_[2];  //!< the last scan, and the one before it
};
}  // namespace dyslam
