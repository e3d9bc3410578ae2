// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "shapes/Mesh.h"

namespace dyslam::sim
{
/** Gentle hills: a sum of a few sine waves [m]. */
class Terrain
{
 public:
  Terrain() = default;
  /** \param slope approximate largest slope (0.04 = 4 %) \param bumps scale of the short waves
   */
  Terrain(std::uint64_t seed, double slope, double bumps);
  [[nodiscard]] double height(double x, double y) const;

 private:
  struct Wave
  {
    double kx, ky, phase, amplitude;
  };
  std::vector<Wave> waves_;
};

/** The drivable and walkable surface. World builders lay out streets in `local` coordinates (u, v)
 * [m], which a smooth map warps to world coordinates (x, y) [m]. */
class Ground
{
 public:
  virtual ~Ground() = default;
  [[nodiscard]] virtual Eigen::Vector2d toWorld(const Eigen::Vector2d& local) const = 0;
  [[nodiscard]] virtual Eigen::Vector2d toLocal(const Eigen::Vector2d& world) const = 0;
  [[nodiscard]] virtual double heightLocal(const Eigen::Vector2d& local) const = 0;
  [[nodiscard]] double height(const Eigen::Vector2d& world) const
  {
    return heightLocal(toLocal(world));
  }
  /** Heading of local +u in the world [rad]. */
  [[nodiscard]] double headingOfU(const Eigen::Vector2d& local) const;
  [[nodiscard]] Eigen::Vector3f point(const Eigen::Vector2d& local, double above = 0) const;
};

/** Mesh over the lines u x v with heights from the ground; `material` is evaluated at each cell's
 * centre. */
[[nodiscard]] Mesh gridMesh(const Ground& ground,
                            const std::vector<double>& u_lines,
                            const std::vector<double>& v_lines,
                            const std::function<Material(double, double)>& material);

/** The `fixed` lines, sorted, with lines added in each gap that are at most `step(middle of gap)`
 * apart. */
[[nodiscard]] std::vector<double> fillLines(std::vector<double> fixed,
                                            const std::function<double(double)>& step);
}  // namespace dyslam::sim
