// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace dyslam::test
{
/** Upright boxes on flat ground, z = 0, with a ray caster. */
class BoxWorld
{
 public:
  /** Houses of all sizes along both sides of a rectangular street of the given half extents. */
  BoxWorld(unsigned seed, double half_x, double half_y) : rng_(seed)
  {
    for (const double side : {-1.0, 1.0})
    {
      for (double x = -half_x - 20; x < half_x + 20; x += uniform(5, 11))
      {
        addHouse(x, side * (half_y + uniform(6, 12)));
        addHouse(x, side * (half_y - uniform(6, 12)));
      }
      for (double y = -half_y - 5; y < half_y + 5; y += uniform(5, 11))
      {
        addHouse(side * (half_x + uniform(6, 12)), y);
        addHouse(side * (half_x - uniform(6, 12)), y);
      }
    }
  }

  /** A square street of the given half extent whose four sides look alike. */
  [[nodiscard]] static BoxWorld square(unsigned seed, double half)
  {
    BoxWorld world(seed);
    for (double x = -half - 5; x < half + 5; x += world.uniform(5, 11))
    {
      world.addHouse(x, -half - world.uniform(6, 12));
      world.addHouse(x, -half + world.uniform(6, 12));
    }
    const std::vector<Block> side = world.blocks_;
    for (int turns = 1; turns < 4; ++turns)
    {
      for (Block block : side)
      {
        for (int i = 0; i < turns; ++i)
        {
          block = {{-block.high.y(), block.low.x(), block.low.z()},
                   {-block.low.y(), block.high.x(), block.high.z()}};
        }
        world.blocks_.push_back(block);
      }
    }
    return world;
  }

  /** Scan in the vehicle frame [m]: 32 beams, one ray per degree, sensor at the origin. */
  [[nodiscard]] std::vector<Eigen::Vector3f> scan(const Pose& T_world_vehicle, unsigned seed) const
  {
    std::mt19937 rng(seed);
    std::normal_distribution<double> noise(0, 0.02);
    std::vector<Eigen::Vector3f> points;
    for (int ring = 0; ring < 32; ++ring)
    {
      const double elevation = (-25 + ring) * M_PI / 180;
      for (int k = 0; k < 360; ++k)
      {
        const double azimuth = k * M_PI / 180;
        const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                        std::cos(elevation) * std::sin(azimuth),
                                        std::sin(elevation));
        const double range =
            cast(T_world_vehicle.translation(), T_world_vehicle.linear() * direction);
        if (range < 80)
        {
          points.push_back(((range + noise(rng)) * direction).cast<float>());
        }
      }
    }
    return points;
  }

 private:
  struct Block
  {
    Eigen::Vector3d low;
    Eigen::Vector3d high;
  };

  explicit BoxWorld(unsigned seed) : rng_(seed) {}

  double uniform(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }

  void addHouse(double x, double y)
  {
    const Eigen::Vector3d half(uniform(1, 3), uniform(1, 3), 0);
    const Eigen::Vector3d at(x, y, 0);
    blocks_.push_back({at - half, at + half + Eigen::Vector3d(0, 0, uniform(1.5, 9))});
  }

  [[nodiscard]] double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const
  {
    double best =
        direction.z() < 0 ? -origin.z() / direction.z() : std::numeric_limits<double>::infinity();
    for (const Block& block : blocks_)
    {
      double enter = 0;
      double leave = best;
      for (int axis = 0; axis < 3 && enter < leave; ++axis)
      {
        const double a = (block.low[axis] - origin[axis]) / direction[axis];
        const double b = (block.high[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave && enter > 0)
      {
        best = enter;
      }
    }
    return best;
  }

  std::mt19937 rng_;
  std::vector<Block> blocks_;
};

/** Poses along the street, anticlockwise with rounded corners, `spacing` apart, sensor at 1.7 m. */
inline std::vector<Pose> driveAround(double half_x, double half_y, double length, double spacing)
{
  constexpr double radius = 5;
  const double straight_x = 2 * (half_x - radius);
  const double straight_y = 2 * (half_y - radius);
  const double arc = M_PI / 2 * radius;
  const double lengths[8] = {straight_x, arc, straight_y, arc, straight_x, arc, straight_y, arc};
  std::vector<Pose> poses;
  Pose pose = poseFromYpr(-half_x + radius, -half_y, 1.7, 0, 0, 0);
  double in_piece = 0;
  int piece = 0;
  for (double s = 0; s < length; s += spacing)
  {
    poses.push_back(pose);
    double left = spacing;
    while (left > 0)
    {
      const double go = std::min(left, lengths[piece] - in_piece);
      Vector6 twist = Vector6::Zero();
      twist[0] = go;
      twist[5] = piece % 2 == 1 ? go / radius : 0;
      pose = pose * expSE3(twist);
      left -= go;
      in_piece += go;
      if (in_piece >= lengths[piece] - 1e-9)
      {
        in_piece = 0;
        piece = (piece + 1) % 8;
      }
    }
  }
  return poses;
}
}  // namespace dyslam::test
