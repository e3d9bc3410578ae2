// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "Ground.h"
#include "Random.h"
#include "Roads.h"

namespace dyslam::sim
{
class World;

/** A street, straight in local coordinates. */
struct Street
{
  double centre = 0;       //!< local coordinate u or v of the centre line [m]
  double lane = 3.4;       //!< width of one lane [m]
  int lanes = 1;           //!< number of lanes each way
  double parking = 2.2;    //!< width of the parking strips on both sides; 0 for none [m]
  double walk = 3;         //!< width of the pavement [m]
  bool trees = false;      //!< trees in the pavement
  double occupancy = 0.6;  //!< share of the parking strips that is occupied
  /** Half the width of the lanes of both directions [m]. */
  [[nodiscard]] double carriageway() const { return lanes * lane; }
  [[nodiscard]] double half() const { return carriageway() + parking; }
};

/** Blocks inside the ego's loop. */
struct BlockRing
{
  int u = 1;  //!< number along u
  int v = 1;  //!< number along v
};

/** Draws the blocks of a loop of about `loop_length` around blocks of side `block_size` [m]. */
[[nodiscard]] BlockRing drawBlockRing(double loop_length, double block_size, Rng& rng);

/** A street of a town with gardens and parked cars. */
[[nodiscard]] Street drawTownStreet(Rng& rng);

/** Orthogonal streets in local coordinates: `along_v` at constant u, `along_u` at constant v.
 * Blocks lie between them and around the outermost streets. */
class StreetGrid : public Ground
{
 public:
  enum class Zone
  {
    road,
    parking,
    walk,
    block
  };

  /** \param draw draws a street; its centre is set by the grid */
  StreetGrid(std::uint64_t seed,
             int blocks_u,
             int blocks_v,
             double block_size,
             const std::function<Street(Rng&)>& draw = drawTownStreet);

  [[nodiscard]] Eigen::Vector2d toWorld(const Eigen::Vector2d& local) const override;
  [[nodiscard]] Eigen::Vector2d toLocal(const Eigen::Vector2d& world) const override;
  [[nodiscard]] double heightLocal(const Eigen::Vector2d& local) const override;

  [[nodiscard]] Zone zone(double u, double v) const;
  [[nodiscard]] Material surface(double u, double v) const;
  [[nodiscard]] Mesh mesh() const;

  std::vector<Street> along_v, along_u;
  double belt = 45;    //!< depth of the surrounding blocks [m]
  bool paved = false;  //!< blocks have no lawn and no soil

  /** Edges u0, v0, u1, v1 of a block inside the pavements [m]. \param i, j indices of the block,
   * from -1 */
  [[nodiscard]] std::array<double, 4> blockInside(int i, int j) const;
  /** Edges u0, v0, u1, v1 of a block at the kerbs [m]. */
  [[nodiscard]] std::array<double, 4> blockKerb(int i, int j) const;
  [[nodiscard]] double minU() const
  {
    return along_v.front().centre - along_v.front().half() - belt;
  }
  [[nodiscard]] double maxU() const { return along_v.back().centre + along_v.back().half() + belt; }
  [[nodiscard]] double minV() const
  {
    return along_u.front().centre - along_u.front().half() - belt;
  }
  [[nodiscard]] double maxV() const { return along_u.back().centre + along_u.back().half() + belt; }

 private:
  Terrain terrain_;
  double amplitude_u_, amplitude_v_, k_u_, k_v_, phase_u_, phase_v_;
  std::uint64_t seed_;
};

/** One side of a street. */
struct Kerb
{
  const Street& street;
  bool along_v;  //!< the street is one of StreetGrid::along_v
  double side;   //!< 1: on the right in the direction of increasing v or u, else -1
  /** \param s along the street \param d from the centre line to this side [m] \return local
   * coordinates [m] */
  [[nodiscard]] Eigen::Vector2d at(double s, double d) const
  {
    return along_v ? Eigen::Vector2d(street.centre + side * d, s)
                   : Eigen::Vector2d(s, street.centre - side * d);
  }
  /** Whether a place is more than `margin` away from the streets that cross [m]. */
  [[nodiscard]] bool isClear(const StreetGrid& grid, double s, double margin) const;
};

/** Lanes, junctions and turns of the grid, and a closed route around the central `ring_u x ring_v`
 * blocks from block (first_u, first_v). */
[[nodiscard]] LaneNetwork makeLanes(
    const StreetGrid& grid, int first_u, int first_v, int ring_u, int ring_v, bool clockwise);
/** Pavements around each block and crossings near the junctions. */
[[nodiscard]] WalkNetwork makeWalks(const StreetGrid& grid);
/** Bicycle loops around blocks at the edge of the carriageway, in the direction of traffic. */
[[nodiscard]] std::vector<Path> makeBicycleLoops(const StreetGrid& grid);
/** Sets the networks of a world's grid: lanes with the ego's route around the ring, whose first
 * block is (1, 1), pavements and bicycle loops. */
void setNetworks(const StreetGrid& grid, const BlockRing& ring, bool clockwise, World& world);
}  // namespace dyslam::sim
