// SPDX-License-Identifier: BSD-3-Clause
// The parts of a downtown world: its streets and its blocks of houses.
#pragma once

#include <vector>

#include "StreetGrid.h"
#include "World.h"

namespace dyslam::sim
{
/** Shapes on pavements and in yards, registered once per world. */
struct DowntownShapes
{
  DowntownShapes(World& world, Rng& rng);

  std::vector<int> scooters, stalls, umbrellas, goods, racks, trees, bushes, signs, fences, clutter;
  int pole = 0, lamp = 0, light = 0, bollard = 0, barrier = 0;
};

/** What the builders of streets and blocks share. */
class Downtown
{
 public:
  /** Registers the shapes. World, grid and generator outlive the object. \param low, high corners
   * of the ego's loop, local coordinates [m] */
  Downtown(World& w,
           const StreetGrid& streets,
           const Eigen::Vector2d& low,
           const Eigen::Vector2d& high,
           Rng& draws);

  /** Whether the ego can see a place from close by. \param local [m] */
  [[nodiscard]] bool near(const Eigen::Vector2d& local) const;
  /** Places a parked motor scooter, which leans on its stand. \param local [m] \param yaw in the
   * world frame [rad] */
  void placeScooter(const Eigen::Vector2d& local, double yaw);

  World& world;
  const StreetGrid& grid;
  Rng& rng;
  DowntownShapes shapes;
  std::vector<int> parked_trucks;  //!< models that fit into a parking strip

 private:
  Eigen::Vector2d ring_low_, ring_high_;  // local coordinates [m]
};

/** Adds the parked vehicles of a street and what stands on its pavements. \param from, to range
 * along the street [m] */
void addDowntownStreet(
    Downtown& town, const Street& street, bool runs_along_v, double from, double to);

/** Adds traffic lights, or signs, at the four corners of a junction. */
void addDowntownJunction(Downtown& town, const Street& a, const Street& b, bool lights);

/** Adds the houses around a block. \param i, j indices of the block, from -1 */
void addDowntownBlock(Downtown& town, int i, int j);
}  // namespace dyslam::sim
