// SPDX-License-Identifier: BSD-3-Clause
// The parts of an indoor world: its plan, and what is in its rooms.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "FloorPlan.h"
#include "Random.h"
#include "World.h"

namespace dyslam::sim
{
/** Distance between the walls of neighbouring rooms [m]. */
constexpr double kWallThickness = 0.2;

/** A room, with vertical walls around a rectangle. */
struct Space
{
  enum class Kind
  {
    corridor,
    hall,
    shop,
    office,
    store  //!< of a warehouse
  };
  Kind kind = Kind::corridor;
  Rect floor;
  double height = 3;  //!< of the ceiling [m]
};

/** A side of a room: a horizontal line at `at`, from `low` to `high`. */
struct RoomSide
{
  bool along_x = true;
  double at = 0;             //!< y if along x, else x [m]
  double low = 0, high = 0;  //!< [m]
  double outward = 1;        //!< direction out of the room on the other axis, 1 or -1

  [[nodiscard]] Eigen::Vector2d point(double along, double out) const
  {
    const double across = at + outward * out;
    return along_x ? Eigen::Vector2d(along, across) : Eigen::Vector2d(across, along);
  }
};
/** The four sides of a rectangle. */
[[nodiscard]] std::vector<RoomSide> sidesOf(const Rect& rect);

/** A hole through the walls of two rooms. */
struct Opening
{
  bool along_x = true;
  double first = 0, second = 0;  //!< position of the two walls on the other axis [m]
  double low = 0, high = 0;      //!< [m]
  double height = 2.1;           //!< [m]
  bool glass = false;            //!< a front of glass panes, with a door in its middle
};

/** A way into a room: from the middle of a corridor through the door to a place inside. */
struct RoomDoor
{
  Eigen::Vector2d before, inside;
  double half_width;  //!< [m]
  int room;           //!< index in IndoorPlan::spaces
  int host;           //!< the corridor or hall it opens to
};

/** A hall and four corridors that form a ring with it, rooms on both sides. The hall is on the side
 * of low y; the ring's corners are the origin, (a, 0), (a, b) and (0, b). */
struct IndoorPlan
{
  /** \param loop_length of the ego's path [m] */
  IndoorPlan(Rng& rng, double loop_length);

  double a = 0, b = 0;        //!< [m]
  std::vector<Space> spaces;  //!< the first is the hall, then five pieces of corridor
  std::vector<Opening> openings;
  std::vector<RoomDoor> doors;
  double bay_x = 8, bay_y = 7;               //!< distances between the hall's columns [m]
  int bays = 4;                              //!< number of bays along x
  int bays_above = 0, bays_below = 3;        //!< beside the bay of the way through, along y
  std::vector<Eigen::Vector2d> ego_corners;  //!< of the ego's closed path

  /** Middle of a bay of the hall. \param j 0: the bay of the way through */
  [[nodiscard]] Eigen::Vector2d bayCentre(int i, int j) const;

 private:
  void addCorridors(Rng& rng);
  void addEgoPath(Rng& rng, int detour, int detour_from, int detour_to);
  void addRooms(Rng& rng, int host, const RoomSide& side);
  bool addRoom(Rng& rng, int host, const RoomSide& side, Space::Kind kind, double from, double to);
};

/** Builds walls, ceilings and furniture of a plan. */
void addWalls(World& world, const IndoorPlan& plan, Rng& rng);
void addFurniture(World& world, const IndoorPlan& plan, Rng& rng);
}  // namespace dyslam::sim
