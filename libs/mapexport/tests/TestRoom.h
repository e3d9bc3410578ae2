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

/** One scan by two lidars that stand 5.15 m apart, both 1.1 m high: the second one sees (9.1, 5.15,
 * 1.1) behind a thing at (8.1, 5.15, 1.1), which the first one sees, and which lets rays pass. */
[[nodiscard]] inline TestMap seenByTwoLidars()
{
  StaticMapOptions options;
  options.visibility = false;
  TestMap map(options);
  Frame frame;
  frame.scan.T_vehicle_lidar.translation().z() = 1.1;
  ScanPart part;
  part.T_scan_lidar.translation().y() = 5.15;
  frame.cloud.points = {{-4, -4, 0.02F},     {9, -4, 0.02F},      {-4, 9, 0.02F},
                        {9, 9, 0.02F},       {8.1F, 5.15F, 1.1F}, {8.1F, 5.15F, 0.02F},
                        {9.1F, 5.15F, 1.1F}, {9.1F, 5.15F, 0.02F}};
  part.begin = 6;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    frame.cloud.intensity.push_back(0.25F);
    frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
  }
  frame.scan.parts = {part};
  map.insert(frame);
  return map;
}
}  // namespace dyslam::test
