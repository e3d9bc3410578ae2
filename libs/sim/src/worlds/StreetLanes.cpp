// SPDX-License-Identifier: BSD-3-Clause
// Lanes, walks and bicycle loops of a street grid.
#include <cmath>
#include <map>

#include "StreetGrid.h"
#include "World.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

/** Compass: 0 = +u, 1 = +v, 2 = -u, 3 = -v. */
struct LaneKey
{
  int i, j, direction;
  int lane = 0;  // 0 beside the centre line
  bool operator<(const LaneKey& o) const
  {
    return std::tie(i, j, direction, lane) < std::tie(o.i, o.j, o.direction, o.lane);
  }
};

constexpr double kSetback = 5.0;  // distance of the stop line from the crossing carriageway [m]

Path warped(const StreetGrid& grid, const P& from, const P& to)
{
  std::vector<P> points;
  const int count = std::max(2, static_cast<int>((to - from).norm() / 2));
  for (int k = 0; k <= count; ++k)
  {
    points.push_back(grid.toWorld(from + (to - from) * k / count));
  }
  return Path(points);
}

/** The lane that leaves junction (i, j) in a direction (right-hand traffic). */
Path laneFrom(const StreetGrid& grid, const LaneKey& k)
{
  const auto& su = grid.along_v;
  const auto& sv = grid.along_u;
  const auto at = [](const std::vector<Street>& s, int index) -> const Street&
  { return s[static_cast<std::size_t>(index)]; };
  const double across = k.lane + 0.5;  // distance from the centre line [widths of a lane]
  if (k.direction % 2 == 0)
  {
    const double sign = k.direction == 0 ? 1 : -1;
    const Street &here = at(su, k.i), &there = at(su, k.i + static_cast<int>(sign)),
                 &street = at(sv, k.j);
    const double v = street.centre - sign * across * street.lane;
    return warped(grid, {here.centre + sign * (here.half() + kSetback), v},
                  {there.centre - sign * (there.half() + kSetback), v});
  }
  const double sign = k.direction == 1 ? 1 : -1;
  const Street &here = at(sv, k.j), &there = at(sv, k.j + static_cast<int>(sign)),
               &street = at(su, k.i);
  const double u = street.centre + sign * across * street.lane;
  return warped(grid, {u, here.centre + sign * (here.half() + kSetback)},
                {u, there.centre - sign * (there.half() + kSetback)});
}

using Junction = std::array<int, 2>;  // numbers of the junction's two streets
constexpr std::array<Junction, 4> kStep{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Junction junctionAfter(const Junction& junction, int direction)
{
  const Junction& step = kStep[static_cast<std::size_t>(direction)];
  return {junction[0] + step[0], junction[1] + step[1]};
}

/** Number of lanes that leave a junction in a direction. */
int lanesTowards(const StreetGrid& grid, const Junction& junction, int direction)
{
  return direction % 2 == 0 ? grid.along_u[static_cast<std::size_t>(junction[1])].lanes
                            : grid.along_v[static_cast<std::size_t>(junction[0])].lanes;
}

/** Adds the lanes from each junction to each of its neighbours. \return numbers of the lanes */
std::map<LaneKey, int> addStreetLanes(const StreetGrid& grid, int nu, int nv, LaneNetwork& net)
{
  std::map<LaneKey, int> ids;
  Rng rng(combine(static_cast<std::uint64_t>(nu * 131 + nv), 7));
  for (int i = 0; i < nu; ++i)
  {
    for (int j = 0; j < nv; ++j)
    {
      for (int d = 0; d < 4; ++d)
      {
        const auto [ti, tj] = junctionAfter({i, j}, d);
        if (ti < 0 || tj < 0 || ti >= nu || tj >= nv)
        {
          continue;
        }
        for (int k = 0; k < lanesTowards(grid, {i, j}, d); ++k)
        {
          Lane lane;
          lane.path = laneFrom(grid, {i, j, d, k});
          lane.speed_limit = rng.uniform(10, 15);
          ids[{i, j, d, k}] = static_cast<int>(net.lanes.size());
          net.lanes.push_back(lane);
        }
      }
    }
  }
  return ids;
}

constexpr int kRight = 3, kStraight = 0, kLeft = 1;  // turns, added to a direction

/** Turns that may be taken from a lane, in the order right, straight on, left: a street's outermost
 * lane turns right and its innermost one left, but a lane without any such turn has all there are.
 * \param towards whether a street leaves the junction in a direction */
template <typename Towards>
std::vector<int> turnsFrom(const LaneKey& from, int lanes, const Towards& towards)
{
  std::vector<int> all, own;
  for (const int turn : {kRight, kStraight, kLeft})
  {
    if (towards((from.direction + turn) % 4))
    {
      all.push_back(turn);
      if (turn == kStraight || from.lane == (turn == kRight ? lanes - 1 : 0))
      {
        own.push_back(turn);
      }
    }
  }
  return own.empty() ? all : own;
}

/** The lane that a turn leads to. */
int laneAfter(int turn, int lane, int lanes_before, int lanes_after)
{
  if (turn == kRight && lane == lanes_before - 1)
  {
    return lanes_after - 1;
  }
  return std::min(lane, lanes_after - 1);
}

/** Adds the lanes across the junctions (turns). \return numbers of the turns, by the lanes that
 * they connect */
std::map<std::pair<int, int>, int> addTurns(const StreetGrid& grid,
                                            const std::map<LaneKey, int>& ids,
                                            int nv,
                                            LaneNetwork& net)
{
  std::map<std::pair<int, int>, int> turn_between;
  for (const auto& [from, from_id] : ids)
  {
    const Junction at = junctionAfter({from.i, from.j}, from.direction);
    const int lanes = lanesTowards(grid, at, from.direction);
    const auto towards = [&](int direction) { return ids.count({at[0], at[1], direction, 0}) > 0; };
    for (const int turn : turnsFrom(from, lanes, towards))
    {
      const int direction = (from.direction + turn) % 4;
      const int to_lane = laneAfter(turn, from.lane, lanes, lanesTowards(grid, at, direction));
      const int to = ids.at({at[0], at[1], direction, to_lane});
      Lane lane;
      const auto start = net.lanes[static_cast<std::size_t>(from_id)].path.at(1e9);
      const auto end = net.lanes[static_cast<std::size_t>(to)].path.at(0);
      lane.path =
          Path(bezier(start.position, start.heading, end.position, end.heading, kTurnPoints));
      lane.junction = at[0] * nv + at[1];
      lane.speed_limit = turn == kStraight ? 11 : turn == kRight ? 5.0 : 6.0;
      lane.next = {to};
      lane.axis = from.direction % 2;
      const int id = static_cast<int>(net.lanes.size());
      net.lanes.push_back(lane);
      net.lanes[static_cast<std::size_t>(from_id)].next.push_back(id);
      turn_between[{from_id, to}] = id;
    }
  }
  return turn_between;
}

/** Junctions of the ego's ring in anticlockwise order. */
std::vector<Junction> ringJunctions(int first_u, int first_v, int ring_u, int ring_v)
{
  std::vector<Junction> ring;
  const int u1 = first_u + ring_u, v1 = first_v + ring_v;
  for (int i = first_u; i < u1; ++i)
  {
    ring.push_back({i, first_v});
  }
  for (int j = first_v; j < v1; ++j)
  {
    ring.push_back({u1, j});
  }
  for (int i = u1; i > first_u; --i)
  {
    ring.push_back({i, v1});
  }
  for (int j = v1; j > first_v; --j)
  {
    ring.push_back({first_u, j});
  }
  return ring;
}
}  // namespace

LaneNetwork makeLanes(
    const StreetGrid& grid, int first_u, int first_v, int ring_u, int ring_v, bool clockwise)
{
  LaneNetwork net;
  const int nu = static_cast<int>(grid.along_v.size()), nv = static_cast<int>(grid.along_u.size());
  const std::map<LaneKey, int> ids = addStreetLanes(grid, nu, nv, net);
  net.junctions = nu * nv;
  const std::map<std::pair<int, int>, int> turn_between = addTurns(grid, ids, nv, net);
  net.findConflicts();

  std::vector<Junction> ring = ringJunctions(first_u, first_v, ring_u, ring_v);
  if (clockwise)
  {
    std::reverse(ring.begin(), ring.end());
  }
  // The ego keeps to the lane that turns as its route does.
  std::vector<int> route;
  for (std::size_t k = 0; k < ring.size(); ++k)
  {
    for (int d = 0; d < 4; ++d)
    {
      if (junctionAfter(ring[k], d) == ring[(k + 1) % ring.size()])
      {
        route.push_back(ids.at(
            {ring[k][0], ring[k][1], d, clockwise ? lanesTowards(grid, ring[k], d) - 1 : 0}));
      }
    }
  }
  for (std::size_t k = 0; k < route.size(); ++k)
  {
    net.ego_route.push_back(route[k]);
    net.ego_route.push_back(turn_between.at({route[k], route[(k + 1) % route.size()]}));
  }
  return net;
}

namespace
{
/** Numbers of the corner nodes, by block and corner: south-west, south-east, north-east,
 * north-west. */
using CornerNodes = std::map<std::array<int, 3>, int>;

/** Adds the pavements around block (i, j) and their corners. */
void addPavements(const StreetGrid& grid, int i, int j, CornerNodes& corner, WalkNetwork& net)
{
  constexpr double kWidth = 1.6;  // [m]
  const int nu = static_cast<int>(grid.along_v.size()), nv = static_cast<int>(grid.along_u.size());
  const auto kerb = grid.blockKerb(i, j), inside = grid.blockInside(i, j);
  std::array<double, 4> mid{};
  for (std::size_t k = 0; k < 4; ++k)
  {
    mid[k] = 0.5 * (kerb[k] + inside[k]) + (k < 2 ? 0.2 : -0.2);
  }
  const std::array<P, 4> corners{P(mid[0], mid[1]), P(mid[2], mid[1]), P(mid[2], mid[3]),
                                 P(mid[0], mid[3])};
  for (int c = 0; c < 4; ++c)
  {
    corner[{i, j, c}] = net.addNode(grid.toWorld(corners[static_cast<std::size_t>(c)]));
  }
  for (int c = 0; c < 4; ++c)
  {
    // Blocks of the belt have no outer pavement.
    const bool outside = (c == 0 && j < 0) || (c == 1 && i == nu - 1) || (c == 2 && j == nv - 1) ||
                         (c == 3 && i < 0);
    if (outside)
    {
      continue;
    }
    // Intermediate nodes follow curved streets.
    const P a = corners[static_cast<std::size_t>(c)],
            b = corners[static_cast<std::size_t>((c + 1) % 4)];
    int previous = corner[{i, j, c}];
    const int pieces = std::max(1, static_cast<int>((b - a).norm() / 15));
    for (int k = 1; k < pieces; ++k)
    {
      const int node = net.addNode(grid.toWorld(a + (b - a) * k / pieces));
      net.addLink(previous, node, false, kWidth);
      previous = node;
    }
    // The fourth side ends at the first corner, which exists already.
    net.addLink(previous, corner[{i, j, (c + 1) % 4}], false, kWidth);
  }
}
}  // namespace

WalkNetwork makeWalks(const StreetGrid& grid)
{
  constexpr double kCrossing = 2;  // width of a crossing [m]
  WalkNetwork net;
  const int nu = static_cast<int>(grid.along_v.size()), nv = static_cast<int>(grid.along_u.size());
  CornerNodes corner;
  for (int i = -1; i < nu; ++i)
  {
    for (int j = -1; j < nv; ++j)
    {
      addPavements(grid, i, j, corner, net);
    }
  }
  for (int i = -1; i < nu; ++i)
  {
    for (int j = -1; j < nv; ++j)
    {
      if (i + 1 < nu)
      {
        net.addLink(corner[{i, j, 1}], corner[{i + 1, j, 0}], true, kCrossing);
        net.addLink(corner[{i, j, 2}], corner[{i + 1, j, 3}], true, kCrossing);
      }
      if (j + 1 < nv)
      {
        net.addLink(corner[{i, j, 3}], corner[{i, j + 1, 0}], true, kCrossing);
        net.addLink(corner[{i, j, 2}], corner[{i, j + 1, 1}], true, kCrossing);
      }
    }
  }
  return net;
}

std::vector<Path> makeBicycleLoops(const StreetGrid& grid)
{
  std::vector<Path> loops;
  const int nu = static_cast<int>(grid.along_v.size()), nv = static_cast<int>(grid.along_u.size());
  for (int i = 0; i + 1 < nu; ++i)
  {
    for (int j = 0; j + 1 < nv; ++j)
    {
      const auto e = grid.blockKerb(i, j);
      // Clockwise, with the block on the right, clear of parked vehicles.
      const auto off = [&](const std::vector<Street>& s, int k)
      { return s[static_cast<std::size_t>(k)].parking + 0.75; };
      const double u0 = e[0] - off(grid.along_v, i), u1 = e[2] + off(grid.along_v, i + 1);
      const double v0 = e[1] - off(grid.along_u, j), v1 = e[3] + off(grid.along_u, j + 1);
      std::vector<P> points =
          roundedCorners({P(u0, v0), P(u0, v1), P(u1, v1), P(u1, v0)}, 5.0, 1.0, true);
      for (auto& p : points)
      {
        p = grid.toWorld(p);
      }
      loops.emplace_back(points, true);
    }
  }
  return loops;
}

void setNetworks(const StreetGrid& grid, const BlockRing& ring, bool clockwise, World& world)
{
  world.roads = makeLanes(grid, 1, 1, ring.u, ring.v, clockwise);
  world.walks = makeWalks(grid);
  world.bicycle_loops = makeBicycleLoops(grid);
  for (const int lane : world.roads.ego_route)
  {
    world.loop_length += world.roads.lanes[static_cast<std::size_t>(lane)].path.length();
  }
}
}  // namespace dyslam::sim
