// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "Generations.h"
#include "GroundHeights.h"

namespace dyslam
{
/** Planes close to the lowest ground around each block of 8 m of the odometry frame: upper limits
 * of the ground in it. Between distant rings no return may be from the ground, but many from the
 * vehicles that pass: without a limit they would be the ground there.
 *
 * Planes are reused for the next scans, whose returns are nearly the same. */
class GroundPlanes
{
 public:
  /** Begins a scan: forgets planes that were fitted 11 to 20 scans before. \param scan number of
   * the scan, ascending */
  void beginScan(std::size_t scan) { planes_.beginScan(scan); }
  /** Fits the planes of the blocks with points that have none. \param scans of the window \param
   * points odometry frame [m] */
  void fit(const std::vector<const LowestReturns*>& scans,
           const std::vector<Eigen::Vector3f>& points);
  /** Highest that the ground can be at a point; infinity if its block has no plane [m]. \param p
   * odometry frame [m] */
  [[nodiscard]] float highestAt(const Eigen::Vector3f& p) const;
  void exchangeState(StateArchive& archive);

 private:
  /** Planes of blocks: z = p . (x, y, 1); without a plane z is infinity. */
  struct Planes
  {
    VoxelHash index;  //!< from the keys of blocks to positions in `planes`
    std::vector<Eigen::Vector3d> planes;

    [[nodiscard]] const Eigen::Vector3d* find(std::uint64_t block) const;
    void clear();
    void exchangeState(StateArchive& archive);
  };

  static constexpr std::size_t period = 10;  //!< of the generations [scans]

  /** Plane of a block, null if none was fitted. */
  [[nodiscard]] const Eigen::Vector3d* find(std::uint64_t block) const;

  Generations<Planes> planes_{period};
};
}  // namespace dyslam
