// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Parallel.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "ScanVisibility.h"

namespace dyslam
{
/** Another scan whose rays are evaluated at voxels of the scan to be decided. */
struct OtherScan
{
  const ScanVisibility* rays;
  Eigen::Isometry3f T_other_this;  //!< takes voxels to the other scan's vehicle frame
  bool after;                      //!< the other scan is later
};

/** Counts of the rays of other scans at a voxel. */
struct RayCounts
{
  std::uint16_t free = 0;
  std::uint16_t occupied = 0;
  /** Largest number of scans earlier than some moment that observed the voxel free, less twice
   * those that observed it occupied: an object that arrived, and stayed or passed, leaves such a
   * change. Thin objects and edges, which are observed free and occupied alternately, do not. */
  std::uint16_t change_before = 0;
  std::uint16_t change_after = 0;  //!< the same of later scans: an object that leaves
};

/** Whether enough scans observed a voxel, and none free. */
[[nodiscard]] bool isClear(const RayCounts& counts);

/** How many of the other scans are evaluated at a voxel. */
enum class RayEffort
{
  few,        //!< every third one
  if_needed,  //!< the others too, if one of these observed it free or hardly any observed it
  all
};

/** Evaluates the other scans at voxels. Most of them are static surfaces that no ray ever passed
 * through, for which a few scans suffice.
 * \param others those before and those after each in order of their distance in time
 * \param voxels a point of each, vehicle frame of the scan to be decided [m] \param efforts one
 * value per voxel \param size of a voxel and \param margin of a ray behind it, see
 * ScanVisibility::evaluate() [m]. Same result for any number of threads. */
[[nodiscard]] std::vector<RayCounts> countRays(const std::vector<OtherScan>& others,
                                               const std::vector<Eigen::Vector3f>& voxels,
                                               const std::vector<RayEffort>& efforts,
                                               float size,
                                               float margin,
                                               ThreadPool& pool);
}  // namespace dyslam
