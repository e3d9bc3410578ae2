// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/ScanParts.h>

#include <cstddef>
#include <vector>

#include "VisibilityImage.h"

namespace dyslam
{
/** What the rays of one scan observed: a voxel is occupied if any lidar of the scan observed it as
 * occupied, else free if any lidar observed it as free. */
class ScanVisibility
{
 public:
  /** \param cloud points of the scan, vehicle frame [m] */
  ScanVisibility(const Scan& scan, const Cloud& cloud);
  /** Without rays, for exchangeState(). */
  ScanVisibility() = default;

  /** As VisibilityImage::evaluate(). */
  void evaluate(const Eigen::Vector3f* voxels,
                std::size_t count,
                const Eigen::Isometry3f& T_vehicle_voxels,
                float size,
                float margin,
                Evidence* evidence) const;
  /** Whether rays passed through each of the voxels (vehicle frame [m]), or at least around it, by
   * VisibilityImage::at(). */
  [[nodiscard]] std::vector<bool> observeFree(const std::vector<Eigen::Vector3f>& voxels,
                                              float size,
                                              float margin) const;

  void exchangeState(StateArchive& archive);

 private:
  std::vector<VisibilityImage> lidars_;
};
}  // namespace dyslam
