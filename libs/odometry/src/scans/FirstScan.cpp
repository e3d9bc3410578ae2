// SPDX-License-Identifier: BSD-3-Clause
#include "FirstScan.h"

#include <dyslam/base/StateArchive.h>

#include <vector>

namespace dyslam
{
void FirstScan::fill(SurfacePyramid& map, const Pose& T_sweep, ThreadPool& pool) const
{
  std::vector<Eigen::Vector3f> deskewed;
  points_.deskewed(T_sweep, pool, deskewed);
  map.clear();
  map.add(deskewed, points_.weight, T_odom_vehicle_);
}

void FirstScan::exchangeState(StateArchive& archive)
{
  archive(points_, T_odom_vehicle_);
}
}  // namespace dyslam
