// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <cmath>
#include <cstddef>

namespace dyslam::test
{
/** A street along x between two walls; a box stands in the way of the first scans and is gone
 * later. The last points of each scan are labelled moving. */
inline Frame streetScan(std::size_t k)
{
  Frame frame;
  frame.index = 2 * k;
  frame.scan.stamp = 100 + static_cast<double>(k);
  frame.scan.T_vehicle_lidar.translation().z() = 1.7;
  frame.T_odom_vehicle = poseFromYpr(1.5 * static_cast<double>(k), 0.3, 0, 0.02, 0, 0);
  const Pose T_vehicle_map = frame.T_odom_vehicle.inverse();
  frame.cloud.T_sweep = poseFromYpr(1.5, 0, 0, 0.01, 0, 0);
  const double at = frame.T_odom_vehicle.translation().x();
  const auto add = [&](double x, double y, double z, bool moving)
  {
    frame.cloud.points.push_back((T_vehicle_map * Eigen::Vector3d(x, y, z)).cast<float>());
    frame.cloud.intensity.push_back(static_cast<float>(std::abs(std::sin(x))));
    frame.cloud.source.push_back(0);
    frame.cloud.phase.push_back(static_cast<float>(std::atan2(y, x - at) / 6.3));
    frame.moving.push_back(moving);
  };
  for (double x = at - 25; x < at + 25; x += 0.17)
  {
    for (double y = -6; y < 6; y += 0.31)
    {
      add(x, y, 0.01, false);
    }
    for (double z = 0.1; z < 3; z += 0.23)
    {
      add(x, 6.05, z, false);
      add(x, -6.05, z, false);
    }
  }
  for (double z = 0.5; z < 1.5 && k < 3; z += 0.1)
  {
    add(12.1, 1.0, z, false);
    add(14.1, 1.0 + z, z, true);
  }
  return frame;
}
}  // namespace dyslam::test
