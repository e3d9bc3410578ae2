// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "TestMap.h"

namespace dyslam::test
{
/** A flat floor of 20 m by 20 m with a wall 1.5 m high at x = 8, seen from three places. */
[[nodiscard]] inline TestMap room()
{
  TestMap map;
  for (std::size_t k = 0; k < 3; ++k)
  {
    Frame frame;
    frame.index = 10 * k;
    frame.scan.stamp = 1000 + static_cast<double>(k);
    frame.scan.T_vehicle_lidar.translation().z() = 1.7;
    frame.T_odom_vehicle = poseFromYpr(static_cast<double>(k), 0, 0, 0.2, 0, 0);
    const Pose T_vehicle_map = frame.T_odom_vehicle.inverse();
    const auto add = [&](double x, double y, double z)
    {
      frame.cloud.points.push_back((T_vehicle_map * Eigen::Vector3d(x, y, z)).cast<float>());
      frame.cloud.intensity.push_back(0.25F);
      frame.cloud.source.push_back(0);
    };
    for (double y = -9.95; y < 10; y += 0.1)
    {
      for (double x = -9.95; x < 8; x += 0.1)
      {
        add(x, y, 0.02);
      }
      for (double z = 0.05; z < 1.5; z += 0.1)
      {
        add(8.05, y, z);
      }
    }
    map.insert(frame);
  }
  return map;
}
}  // namespace dyslam::test
