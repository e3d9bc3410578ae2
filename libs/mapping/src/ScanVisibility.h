// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/ScanParts.h>

#include <cstddef>
#include <vector>

#include "VisibilityImage.h"

namespace dyslam
{
/** What the rays of one scan, of all its lidars, observed: a voxel is occupied if it is for one of
 * them, else free if it is for one. */
class ScanVisibility
{
 public:
  /** \param cloud of the scan, vehicle frame */
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
  /** VisibilityImage::at() of a voxel in the vehicle frame: rays passed through it, or at least
   * around it. */
  [[nodiscard]] bool observesFree(const Eigen::Vector3f& p, float size, float margin) const;

  void exchangeState(StateArchive& archive);

 private:
  std::vector<VisibilityImage> lidars_;
};
}  // namespace dyslam
