// SPDX-License-Identifier: BSD-3-Clause
// The plan of an indoor world.
#include <algorithm>
#include <cmath>

#include "Indoor.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

double area(const Rect& r)
{
  return r.size().x() * r.size().y();
}
}  // namespace

std::vector<RoomSide> sidesOf(const Rect& r)
{
  return {{true, r.low.y(), r.low.x(), r.high.x(), -1},
          {true, r.high.y(), r.low.x(), r.high.x(), 1},
          {false, r.low.x(), r.low.y(), r.high.y(), -1},
          {false, r.high.x(), r.low.y(), r.high.y(), 1}};
}

IndoorPlan::IndoorPlan(Rng& rng, double loop_length)
{
  bay_x = rng.uniform(7, 9.5);
  bay_y = rng.uniform(6.6, 8.2);
  bays_below = 2 + rng.below(3);
  // The way through the hall leaves the straight line by this number of bays.
  const int detour = loop_length < 190 ? -1 : -1 - rng.below(std::min(2, bays_below));
  // The corners of the path are rounded, which shortens it.
  const double half = 0.5 * loop_length - std::abs(detour) * bay_y + 3.5;
  b = std::max(20.0, half * rng.uniform(0.3, 0.4));
  a = half - b;
  const double longest = std::min(a - 14, rng.uniform(44, 64));
  bays = std::max(3, static_cast<int>(longest / bay_x));
  bay_x = std::min(bay_x, longest / bays);
  bays_above = b - 1.5 * bay_y > 15 && rng.chance(0.6) ? 1 : 0;
  addCorridors(rng);
  const int from = rng.below(std::max(1, bays / 2));
  const int to = std::min(bays - 1, from + 1 + rng.below(std::max(1, bays - 1 - from)));
  addEgoPath(rng, detour, from, to);
  // Rooms at the hall first, which has the longest walls.
  for (const int host : {0, 1, 2, 3, 4, 5})
  {
    if (static_cast<std::size_t>(host) < spaces.size())
    {
      for (const RoomSide& side : sidesOf(spaces[static_cast<std::size_t>(host)].floor))
      {
        addRooms(rng, host, side);
      }
    }
  }
}

P IndoorPlan::bayCentre(int i, int j) const
{
  return {spaces[0].floor.low.x() + (i + 0.5) * bay_x, j * bay_y};
}

void IndoorPlan::addCorridors(Rng& rng)
{
  constexpr double t = kWallThickness;
  const double south = rng.uniform(4.4, 6.2), north = rng.uniform(4, 6.5),
               west = rng.uniform(4, 6.5), east = rng.uniform(4, 6.5);
  const double height = rng.uniform(3.0, 3.5);
  const double length = bays * bay_x;
  const double x0 = (a - length) * rng.uniform(0.4, 0.6), x1 = x0 + length;
  const double y0 = -(bays_below + 0.5) * bay_y, y1 = (bays_above + 0.5) * bay_y;
  spaces.push_back({Space::Kind::hall, {{x0, y0}, {x1, y1}}, rng.uniform(8, 12)});
  const auto corridor = [&](double u0, double v0, double u1, double v1) {
    spaces.push_back({Space::Kind::corridor, {{u0, v0}, {u1, v1}}, height});
  };
  corridor(-0.5 * west, -0.5 * south, x0 - t, 0.5 * south);
  corridor(x1 + t, -0.5 * south, a + 0.5 * east, 0.5 * south);
  corridor(-0.5 * west, b - 0.5 * north, a + 0.5 * east, b + 0.5 * north);
  corridor(-0.5 * west, 0.5 * south, 0.5 * west, b - 0.5 * north);
  corridor(a - 0.5 * east, 0.5 * south, a + 0.5 * east, b - 0.5 * north);
  openings.push_back({false, x0 - t, x0, -0.5 * south, 0.5 * south, height, false});
  openings.push_back({false, x1, x1 + t, -0.5 * south, 0.5 * south, height, false});
  for (const double y : {0.5 * south, b - 0.5 * north})
  {
    openings.push_back({true, y, y, -0.5 * west, 0.5 * west, height, false});
    openings.push_back({true, y, y, a - 0.5 * east, a + 0.5 * east, height, false});
  }
}

void IndoorPlan::addEgoPath(Rng& rng, int detour, int detour_from, int detour_to)
{
  ego_corners = {{0, 0}};
  if (detour_to > detour_from)
  {
    for (const P& corner : {bayCentre(detour_from, 0), bayCentre(detour_from, detour),
                            bayCentre(detour_to, detour), bayCentre(detour_to, 0)})
    {
      ego_corners.push_back(corner);
    }
  }
  ego_corners.emplace_back(a, 0);
  ego_corners.emplace_back(a, b);
  ego_corners.emplace_back(0, b);
  if (rng.chance(0.5))
  {
    std::reverse(ego_corners.begin(), ego_corners.end());
  }
}

void IndoorPlan::addRooms(Rng& rng, int host, const RoomSide& side)
{
  double s = side.low + rng.uniform(0.8, 2.0);
  while (s < side.high - 3.5)
  {
    const double u = rng.uniform();
    const Space::Kind kind = u < 0.55   ? Space::Kind::shop
                             : u < 0.75 ? Space::Kind::office
                                        : Space::Kind::store;
    const double blank = rng.uniform(0.6, 2.2);
    const double width = kind == Space::Kind::shop     ? rng.uniform(5, 11)
                         : kind == Space::Kind::office ? rng.uniform(3.4, 6)
                                                       : rng.uniform(7.5, 13);
    const bool closed = rng.chance(0.12);  // a piece of wall
    const double end = std::min(s + width, side.high - 0.7);
    if (!closed && end - s > 3 && addRoom(rng, host, side, kind, s, end))
    {
      s = end + blank;
    }
    else
    {
      s += 2.2;
    }
  }
}

bool IndoorPlan::addRoom(
    Rng& rng, int host, const RoomSide& side, Space::Kind kind, double from, double to)
{
  const double deepest = kind == Space::Kind::shop     ? rng.uniform(5, 10)
                         : kind == Space::Kind::office ? rng.uniform(3.5, 6)
                                                       : rng.uniform(8, 14);
  const double height =
      kind == Space::Kind::store && host == 0 ? rng.uniform(4, 6) : rng.uniform(2.8, 3.3);
  for (const double depth : {deepest, 0.6 * deepest})
  {
    const P p = side.point(from, kWallThickness), q = side.point(to, kWallThickness + depth);
    const Rect room{p.cwiseMin(q), p.cwiseMax(q)};
    const bool hits =
        std::any_of(spaces.begin(), spaces.end(),
                    [&](const Space& space) { return space.floor.overlaps(room.grown(0.15)); });
    if (hits || depth < 3 || area(room) < 10)
    {
      continue;
    }
    Opening door;
    door.along_x = side.along_x;
    door.first = side.at;
    door.second = side.at + side.outward * kWallThickness;
    double half_width = 0.5;
    double middle = 0.5 * (from + to) + rng.uniform(-0.2, 0.2) * (to - from);
    if (kind == Space::Kind::shop)
    {
      door.low = from + 0.3;
      door.high = to - 0.3;
      middle = 0.5 * (from + to);
      half_width = 0.9;
      door.height = rng.uniform(2.4, 2.7);
      door.glass = rng.chance(0.45);
    }
    else
    {
      half_width = kind == Space::Kind::office ? 0.5 : rng.uniform(1.2, 1.7);
      door.low = middle - half_width;
      door.high = middle + half_width;
      door.height = kind == Space::Kind::office ? 2.1 : 2.6;
    }
    openings.push_back(door);
    const double reach = host == 0 ? 1.6 : 1.9;
    doors.push_back({side.point(middle, -reach),
                     side.point(middle, kWallThickness + std::min(0.6 * depth, 3.2)), half_width,
                     static_cast<int>(spaces.size()), host});
    spaces.push_back({kind, room, height});
    return true;
  }
  return false;
}
}  // namespace dyslam::sim
