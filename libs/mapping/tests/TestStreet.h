// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/mapping/StaticMap.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace dyslam::test
{
inline constexpr double kHeight = 1.7;  // height of the sensor over the ground [m]

/** A street with walls at y = +-8 m and a pole, seen by rays from the sensor at `x`; a car-sized
 * box stands at `car_x` if that is finite. */
inline Frame scanAt(std::size_t index, double x, double car_x)
{
  Frame frame;
  frame.index = index;
  frame.scan.stamp = 0.1 * static_cast<double>(index);
  frame.scan.T_vehicle_lidar.translation().z() = kHeight;
  frame.T_odom_vehicle.translation().x() = x;
  for (int row = 0; row < 48; ++row)
  {
    for (int col = 0; col < 720; ++col)
    {
      const double elevation = (-24 + 0.6 * row) * M_PI / 180;
      const double azimuth = col * 0.5 * M_PI / 180;
      const Eigen::Vector3d d(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Eigen::Vector3d o(x, 0, kHeight);
      double range = 60;
      bool hit = false;
      const auto nearer = [&](double r)
      {
        if (r > 0 && r < range)
        {
          range = r;
          hit = true;
        }
      };
      nearer(-o.z() / d.z());
      for (const double wall : {-8.0, 8.0})
      {
        const double r = (wall - o.y()) / d.y();
        const double z = o.z() + r * d.z();
        nearer(z < 6 ? r : -1);
      }
      // A thin pole at (10, 3): a cylinder of 6 cm radius.
      const Eigen::Vector2d to = Eigen::Vector2d(10, 3) - o.head<2>();
      const Eigen::Vector2d flat = d.head<2>().normalized();
      if (std::abs(flat.x() * to.y() - flat.y() * to.x()) < 0.06 && flat.dot(to) > 0)
      {
        nearer(flat.dot(to) / d.head<2>().norm());
      }
      if (std::isfinite(car_x))
      {
        const double r = (car_x - 2 - o.x()) / d.x();  // rear and side of a car
        const Eigen::Vector3d p = o + r * d;
        nearer(r > 0 && std::abs(p.y() + 3) < 0.9 && p.z() > 0 && p.z() < 1.5 ? r : -1);
        const double s = (-2.1 - o.y()) / d.y();
        const Eigen::Vector3d q = o + s * d;
        nearer(s > 0 && std::abs(q.x() - car_x) < 2 && q.z() > 0 && q.z() < 1.5 ? s : -1);
      }
      if (hit)
      {
        const Eigen::Vector3d p = o + range * d - Eigen::Vector3d(x, 0, 0);
        frame.cloud.points.push_back(p.cast<float>());
        frame.cloud.intensity.push_back(0.5F);
        frame.cloud.source.push_back(static_cast<std::uint32_t>(frame.cloud.source.size()));
      }
    }
  }
  return frame;
}

inline constexpr double kNoCar = std::numeric_limits<double>::quiet_NaN();

/** Number of map points in an axis-aligned box, borders included. */
inline std::size_t countIn(const MapPoints& map,
                           const Eigen::Vector3f& low,
                           const Eigen::Vector3f& high)
{
  std::size_t count = 0;
  for (const auto& p : map.points)
  {
    count += (p.array() >= low.array()).all() && (p.array() <= high.array()).all() ? 1 : 0;
  }
  return count;
}

/** Number of map points at the height and in the lane of the car of scanAt(). */
inline std::size_t carPoints(const MapPoints& map)
{
  return countIn(map, {-20, -4.5F, 0.4F}, {80, -1.6F, 1.8F});
}

/** Poses along the street. \param step distance between them [m] */
inline std::vector<Pose> posesOf(std::size_t count, double step)
{
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i)
  {
    poses.push_back(poseFromYpr(step * static_cast<double>(i), 0, 0, 0, 0, 0));
  }
  return poses;
}
}  // namespace dyslam::test
