// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cmath>
#include <vector>

namespace dyslam::testing
{
/** Simulated scan of a hall with inner walls by a sensor 1.7 m above the floor at `T_hall_sensor`:
 * [beams x columns] points in the sensor frame. */
inline std::vector<Eigen::Vector3f> room(int beams,
                                         int columns,
                                         const Pose& T_hall_sensor = Pose::Identity())
{
  // Planes n . x = d of a hall, and pillars (boxes) in it.
  struct Box
  {
    Eigen::Vector3d low, high;
  };
  const std::vector<Box> pillars = {{{8, 4, -2}, {9, 6, 3}},     {{-7, -6, -2}, {-5, -5, 3}},
                                    {{12, -7, -2}, {14, -5, 2}}, {{-14, 6, -2}, {-12, 7, 3}},
                                    {{3, -9, -2}, {4, -8, 1}},   {{-3, 8, -2}, {0, 9, 2}}};
  const Eigen::Vector3d hall(22, 12, 5);
  const Eigen::Vector3d origin = T_hall_sensor.translation();
  std::vector<Eigen::Vector3f> points;
  for (int beam = 0; beam < beams; ++beam)
  {
    const double elevation = (-24.0 + 38.0 * (beam + 0.5) / beams) * M_PI / 180;
    for (int col = 0; col < columns; ++col)
    {
      const double azimuth = M_PI - 2 * M_PI * (col + 0.5) / columns;
      const Eigen::Vector3d local(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Eigen::Vector3d ray = T_hall_sensor.linear() * local;
      double range = 1e9;
      for (int axis = 0; axis < 3; ++axis)
      {
        const double floor = axis == 2 ? -1.7 : -hall[axis];
        const double wall = ray[axis] > 0 ? hall[axis] : floor;
        if (std::abs(ray[axis]) > 1e-9)
        {
          range = std::min(range, (wall - origin[axis]) / ray[axis]);
        }
      }
      for (const Box& box : pillars)
      {
        double enter = 0;
        double leave = 1e9;
        for (int axis = 0; axis < 3; ++axis)
        {
          const double a = (box.low[axis] - origin[axis]) / ray[axis];
          const double b = (box.high[axis] - origin[axis]) / ray[axis];
          enter = std::max(enter, std::min(a, b));
          leave = std::min(leave, std::max(a, b));
        }
        if (enter < leave && enter > 0)
        {
          range = std::min(range, enter);
        }
      }
      points.push_back((range * local).cast<float>());
    }
  }
  return points;
}
}  // namespace dyslam::testing
