// SPDX-License-Identifier: BSD-3-Clause
#include "ScanVisibility.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>

namespace dyslam
{
namespace
{
/** Rank of an evidence: of the evidences of several lidars the one of the highest rank is taken. */
int rankOf(Evidence evidence)
{
  switch (evidence)
  {
    case Evidence::none:
      return 0;
    case Evidence::occluded:
      return 1;
    case Evidence::passed_by:
      return 2;
    case Evidence::enclosed:
      return 3;
    case Evidence::free:
      return 4;
    case Evidence::occupied:
      return 5;
  }
  return 0;
}

Evidence joined(Evidence a, Evidence b)
{
  return rankOf(a) < rankOf(b) ? b : a;
}
}  // namespace

ScanVisibility::ScanVisibility(const Scan& scan, const Cloud& cloud)
{
  for (const LidarRange& lidar : lidarRanges(scan, cloud))
  {
    lidars_.emplace_back(cloud, lidar);
  }
}

void ScanVisibility::evaluate(const Eigen::Vector3f* voxels,
                              std::size_t count,
                              const Eigen::Isometry3f& T_vehicle_voxels,
                              float size,
                              float margin,
                              Evidence* evidence) const
{
  if (lidars_.empty())
  {
    std::fill_n(evidence, count, Evidence::none);
    return;
  }
  lidars_.front().evaluate(voxels, count, T_vehicle_voxels, size, margin, evidence);
  std::vector<Evidence> further(lidars_.size() > 1 ? count : 0);
  for (std::size_t k = 1; k < lidars_.size(); ++k)
  {
    lidars_[k].evaluate(voxels, count, T_vehicle_voxels, size, margin, further.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      evidence[i] = joined(evidence[i], further[i]);
    }
  }
}

std::vector<bool> ScanVisibility::observeFree(const std::vector<Eigen::Vector3f>& voxels,
                                              float size,
                                              float margin) const
{
  std::vector<Evidence> seen(voxels.size(), Evidence::none);
  std::vector<Evidence> of_lidar(voxels.size());
  for (const VisibilityImage& lidar : lidars_)
  {
    lidar.at(voxels.data(), voxels.size(), size, margin, of_lidar.data());
    for (std::size_t i = 0; i < seen.size(); ++i)
    {
      seen[i] = joined(seen[i], of_lidar[i]);
    }
  }
  std::vector<bool> free(voxels.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
  {
    free[i] = seen[i] == Evidence::free || seen[i] == Evidence::passed_by;
  }
  return free;
}

void ScanVisibility::exchangeState(StateArchive& archive)
{
  archive(lidars_);
}
}  // namespace dyslam
