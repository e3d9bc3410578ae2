// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Scores of the places of the last scans, to smooth those of the next one over time. At what
 * stands the rays observed nearly the same from scan to scan, but its segment and its causal label
 * may be others for one scan. */
class RecentScores
{
 public:
  /** \param scan number, ascending; forgets what is older than the two scans before. */
  void beginScan(std::size_t scan);
  /** Smooths the score of a place, unless it is sure: the mean with the smoothed score of the same
   * place in one of the two scans before, if it has one. Remembers the result. \param voxel of the
   * place, see Segments::voxel_of_place \param score log odds that it moves \return the smoothed
   * score */
  [[nodiscard]] float smooth(std::uint64_t voxel, float score);
  void exchangeState(StateArchive& archive);

 private:
  struct OfScan
  {
    std::size_t scan = 0;
    VoxelHash index;  //!< of the voxels in `scores`
    std::vector<float> scores;

    void exchangeState(StateArchive& archive);
  };
  OfScan current_;
  OfScan before_[2];  //!< the last scan, and the one before it
};
}  // namespace dyslam
