// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "ScanVisibility.h"

namespace dyslam
{
/** Another scan whose rays are evaluated at voxels of the scan that is labelled. */
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
  /** Evidence that the voxel was free before the labelled scan: over the scans earlier than some
   * moment, the number that observed it free less twice the number that observed it occupied,
   * maximised over that moment. An object that arrived, and stayed or passed, leaves such a change;
   * thin objects and edges, which are observed free and occupied alternately, do not. */
  std::uint16_t change_before = 0;
  std::uint16_t change_after = 0;  //!< as change_before, of later scans: an object that leaves
};

/** Whether enough scans observed a voxel, and none of them as free. */
[[nodiscard]] bool isClear(const RayCounts& counts);

/** How many of the other scans are evaluated at a voxel. */
enum class RayEffort
{
  few,        //!< every third scan
  if_needed,  //!< all, unless enough of every third observed it occupied and none free
  all
};

/** Evaluates the other scans at voxels, one result per voxel. Most voxels are static surfaces that
 * no ray ever passed through, for which a few scans suffice. \param others earlier and later scans,
 * each from the nearest in time to the farthest \param voxels a point of each voxel, vehicle frame
 * of the labelled scan [m] \param efforts one value per voxel \param size side of a voxel [m]
 * \param margin distance behind a voxel at which a ray must end, see ScanVisibility::evaluate()
 * [m]. Same result for any number of threads. */
[[nodiscard]] std::vector<RayCounts> countRays(const std::vector<OtherScan>& others,
                                               const std::vector<Eigen::Vector3f>& voxels,
                                               const std::vector<RayEffort>& efforts,
                                               float size,
                                               float margin,
                                               ThreadPool& pool);
}  // namespace dyslam
