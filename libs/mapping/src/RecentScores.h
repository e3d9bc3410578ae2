// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Scores of the voxels of the last scans, to smooth those of the next one over time. At what
 * stands the rays observed nearly the same from scan to scan, but its segment and its causal label
 * may be others for one scan. */
class RecentScores
{
 public:
  /** \param scan number, ascending; forgets what is older than the two scans before. */
  void beginScan(std::size_t scan);
  /** Smooths the score of a voxel, unless it is sure: the mean with the smoothed score of the same
   * voxel in one of the two scans before, if it has one. Remembers the result. \param key of the
   * voxel, see Segments::key_of_voxel \param score log odds that it moves \return the smoothed
   * score */
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
