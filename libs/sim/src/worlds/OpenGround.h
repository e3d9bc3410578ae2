// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "Ground.h"
#include "Random.h"

namespace dyslam::sim
{
class World;

/** Open terrain with paved strips (paths, roads); world and local coordinates are equal. */
class OpenGround : public Ground
{
 public:
  struct Strip
  {
    Eigen::Vector2d a, b;
    double half_width;  //!< [m]
    Material material;
  };

  /** \param slope, bumps see Terrain \param lumps amplitude of the relief off the strips, 1 for a
   * lawn */
  OpenGround(std::uint64_t seed, double slope, double bumps, double lumps);

  [[nodiscard]] Eigen::Vector2d toWorld(const Eigen::Vector2d& local) const override;
  [[nodiscard]] Eigen::Vector2d toLocal(const Eigen::Vector2d& world) const override;
  [[nodiscard]] double heightLocal(const Eigen::Vector2d& p) const override;

  /** Signed distance to the edge of the nearest strip (negative inside) [m], and the strip. */
  [[nodiscard]] std::pair<double, const Strip*> nearestStrip(const Eigen::Vector2d& p) const;

  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width, Material material);
  void add(const std::vector<Eigen::Vector2d>& line, double width, Material material, bool closed);

  /** Mesh of a rectangle with cells of `step` [m]; `field` is the material off the strips. */
  [[nodiscard]] Mesh mesh(
      double x0, double y0, double x1, double y1, double step, Material field) const;

 private:
  Terrain terrain_;
  double lumps_;
  std::vector<Strip> strips_;
};

/** Shapes of trees, bushes and hedges for open terrain, registered once per world. */
struct OpenGroundPlants
{
  OpenGroundPlants(World& world, Rng& rng);
  std::vector<int> trees, bushes, hedges;
};
}  // namespace dyslam::sim
