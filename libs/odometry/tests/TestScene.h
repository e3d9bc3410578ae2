// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/ScanParts.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace dyslam::test
{
constexpr double degree = M_PI / 180;

/** Scans of a 32-beam sensor 1.7 m above a street with houses, walls across and poles, by exact ray
 * casting. */
class StreetScene
{
 public:
  /** Adds a box, world frame [m]. */
  void add(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
  {
    boxes_.push_back({low, high});
  }

  /** Distance to the first surface along a ray, world frame [m]; infinite if none. */
  [[nodiscard]] double range(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const
  {
    double best = std::numeric_limits<double>::infinity();
    const auto take = [&](double d)
    {
      if (d > 1e-6 && d < best)
      {
        best = d;
      }
    };
    take(-from.z() / along.z());
    for (const Box& box : boxes_)
    {
      take(hitBox(box, from, along));
    }
    for (const Eigen::Vector2d& pole : poles_)
    {
      take(hitPole(pole, from, along));
    }
    return best;
  }

  /** One sweep. With `T_sweep` the vehicle moves by it during the sweep, about its middle.
   * \param noise standard deviation of the ranges [m] */
  [[nodiscard]] Scan scan(const Pose& T_world_vehicle,
                          double noise,
                          unsigned seed,
                          const Pose& T_sweep = Pose::Identity()) const
  {
    constexpr int rings = 32;
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, noise);
    const Vector6 twist = logSE3(T_sweep);
    Scan scan;
    scan.T_vehicle_lidar.translation().z() = 1.7;
    std::vector<Pose> T_world_lidar;  // of each column
    for (int column = 0; column < columns; ++column)
    {
      T_world_lidar.push_back(T_world_vehicle * expSE3((shareOf(column) - 0.5) * twist) *
                              scan.T_vehicle_lidar);
    }
    for (int ring = 0; ring < rings; ++ring)
    {
      const double elevation = (-24.0 + 1.0 * ring) * M_PI / 180;
      for (int column = 0; column < columns; ++column)
      {
        const double share = shareOf(column);
        const double azimuth = M_PI - 2 * M_PI * share;
        const Pose& T = T_world_lidar[static_cast<std::size_t>(column)];
        const Eigen::Vector3d d(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const double r = range(T.translation(), T.linear() * d) + error(random);
        const bool hit = r < 80;
        scan.points.emplace_back(hit ? Eigen::Vector3f((r * d).cast<float>())
                                     : Eigen::Vector3f::Zero());
        scan.time.push_back(static_cast<float>(0.1 * (share - 0.5)));
        scan.ring.push_back(static_cast<std::uint16_t>(ring));
        scan.intensity.push_back(0.5F);
      }
    }
    return scan;
  }

  /** The returns of an instantaneous scan, in the vehicle frame. */
  [[nodiscard]] Frame frame(const Pose& T_world_vehicle, double noise, unsigned seed) const
  {
    Frame frame;
    frame.scan = scan(T_world_vehicle, noise, seed);
    const Pose& T = frame.scan.T_vehicle_lidar;
    for (std::size_t i = 0; i < frame.scan.size(); ++i)
    {
      if (isReturn(frame.scan.points[i]))
      {
        frame.cloud.points.emplace_back((T * frame.scan.points[i].cast<double>()).cast<float>());
        frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
      }
    }
    return frame;
  }

 private:
  static constexpr int columns = 720;

  /** When a column is measured, as a share of the sweep. */
  static double shareOf(int column) { return (column + 0.5) / columns; }

  struct Box
  {
    Eigen::Vector3d low;
    Eigen::Vector3d high;
  };

  static double hitBox(const Box& box, const Eigen::Vector3d& from, const Eigen::Vector3d& along)
  {
    double enter = 0;
    double leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k)
    {
      const double a = (box.low[k] - from[k]) / along[k];
      const double b = (box.high[k] - from[k]) / along[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave ? enter : -1;
  }

  static double hitPole(const Eigen::Vector2d& pole,
                        const Eigen::Vector3d& from,
                        const Eigen::Vector3d& along)
  {
    constexpr double radius = 0.2;
    const Eigen::Vector2d o = from.head<2>() - pole;
    const Eigen::Vector2d d = along.head<2>();
    const double a = d.squaredNorm();
    const double b = o.dot(d);
    if (b > 0)
    {
      return -1;  // behind
    }
    const double root = b * b - a * (o.squaredNorm() - radius * radius);
    if (root < 0)
    {
      return -1;
    }
    const double r = (-b - std::sqrt(root)) / a;
    return from.z() + r * along.z() < 5 ? r : -1;
  }

  std::vector<Box> boxes_{{{-30, 9, 0}, {-6, 14, 8}},   {{-2, 10, 0}, {12, 16, 6}},
                          {{16, 8, 0}, {40, 15, 9}},    {{-40, -16, 0}, {-10, -10, 7}},
                          {{-7, -18, 0}, {8, -9, 10}},  {{13, -15, 0}, {35, -11, 5}},
                          {{4, 5, 0}, {8.2, 6.8, 1.5}}, {{-12, -7, 0}, {-7.8, -5.2, 1.6}},
                          {{50, -20, 0}, {52, 20, 6}},  {{-52, -20, 0}, {-50, 20, 6}}};
  std::vector<Eigen::Vector2d> poles_{{3, -6.5}, {-4, 7},    {14, 6.5},
                                      {18, -7},  {-15, 6.8}, {-20, -7}};
};

/** The frame with an added scan of the scene by a further lidar at the rear. */
inline Frame withFurtherLidar(const Frame& own)
{
  Scan rear = StreetScene().scan(poseFromYpr(-1, 0.5, -0.5, M_PI, 0, 0), 0.01, 11);
  rear.T_vehicle_lidar = poseFromYpr(-1, 0.5, -0.5, M_PI, 0, 0) * rear.T_vehicle_lidar;
  Frame both = own;
  appendScan(rear, 1, both.scan);
  for (std::size_t i = 0; i < rear.size(); ++i)
  {
    if (isReturn(rear.points[i]))
    {
      both.cloud.points.emplace_back(rear.T_vehicle_lidar.cast<float>() * rear.points[i]);
      both.cloud.source.push_back(static_cast<std::uint32_t>(own.scan.size() + i));
    }
  }
  return both;
}

/** Clouds that no algorithm can use. */
inline Frame frameOf(std::vector<Eigen::Vector3f> points)
{
  Frame frame;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
  }
  frame.scan.points = points;
  frame.cloud.points = std::move(points);
  return frame;
}

inline Eigen::Vector3f nanPoint()
{
  return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
}
}  // namespace dyslam::test
