// SPDX-License-Identifier: BSD-3-Clause
// A large public building: a hall, corridors in a ring with it, shops, offices and store rooms.
#include <dyslam/base/Error.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "Indoor.h"
#include "Random.h"
#include "World.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

/** A floor that is level to some millimetres. */
class Floor : public Ground
{
 public:
  P toWorld(const P& local) const override { return local; }
  P toLocal(const P& world) const override { return world; }
  double heightLocal(const P& p) const override
  {
    return 0.003 * std::sin(0.9 * p.x() + 0.3 * p.y()) +
           0.003 * std::sin(0.5 * p.y() - 0.2 * p.x());
  }
};

/** Adds people with suitcases and trolleys, and cleaning machines. */
void addIndoorBodies(World& world, Rng& rng)
{
  const int suitcase = world.addShape(makeSuitcase()),
            trolley = world.addShape(makeShoppingTrolley());
  for (std::size_t i = 0; i < 6; ++i)
  {
    BodyModel model = world.bodies[static_cast<std::size_t>(world.people[i % 3])];
    model.scale = rng.uniform(1.55, 1.92);
    const bool pushes = i >= 4;
    model.luggage_x = pushes ? 0.5 : -0.33;
    const double back = pushes ? -0.26 : -0.42, front = pushes ? 0.79 : 0.26;
    model.size = {(front - back) * model.scale, 0.40 * model.scale, 1.0 * model.scale};
    model.centre_x = 0.5 * (front + back) * model.scale;
    model.shapes.push_back(pushes ? trolley : suitcase);
    world.travellers.push_back(static_cast<int>(world.bodies.size()));
    world.bodies.push_back(model);
  }
  const int machine = addRigid(world, makeCleaningMachine(), ObjectClass::unknown, 0.7);
  world.bodies[static_cast<std::size_t>(machine)].semantic_at_rest = 20;  // other vehicle
  world.bodies[static_cast<std::size_t>(machine)].semantic_moving = 259;
  world.machines.push_back(machine);
}

class IndoorBuilder
{
 public:
  IndoorBuilder(World& world, const IndoorPlan& plan, Rng& rng)
      : world_(world), plan_(plan), rng_(rng)
  {
  }

  void build()
  {
    layFloor();
    addWalls(world_, plan_, rng_);
    addColumns();
    world_.ego_path = Path(roundedCorners(plan_.ego_corners, 1.8, 0.3, true), true);
    world_.loop_length = world_.ego_path.length();
    world_.floor_plan.measureClearance();
    addHallWalks();
    addCorridorWalks();
    addDoors();
    reserveWays();
    addFurniture(world_, plan_, rng_);
    world_.floor_plan.measureClearance();
  }

 private:
  void layFloor()
  {
    Rect extent = plan_.spaces.front().floor;
    for (const Space& space : plan_.spaces)
    {
      extent.low = extent.low.cwiseMin(space.floor.low);
      extent.high = extent.high.cwiseMax(space.floor.high);
    }
    extent = extent.grown(1);
    world_.ground = std::make_unique<Floor>();
    const auto lines = [](double a, double b) {
      return fillLines({a, b}, [](double) { return 1.0; });
    };
    world_.meshes.push_back(gridMesh(*world_.ground, lines(extent.low.x(), extent.high.x()),
                                     lines(extent.low.y(), extent.high.y()),
                                     [](double, double) { return Material::floor; }));
    world_.floor_plan = FloorPlan(extent, 0.1);
    for (const Space& space : plan_.spaces)
    {
      world_.floor_plan.free(space.floor);
    }
    for (const Opening& o : plan_.openings)
    {
      const double low = std::min(o.first, o.second), high = std::max(o.first, o.second);
      world_.floor_plan.free(o.along_x ? Rect{{o.low, low}, {o.high, high}}
                                       : Rect{{low, o.low}, {high, o.high}});
    }
  }

  void addColumns()
  {
    const Space& hall = plan_.spaces.front();
    const double radius = rng_.uniform(0.3, 0.5);
    const bool round = rng_.chance(0.5);
    Mesh mesh;
    const auto height = static_cast<float>(hall.height);
    const auto r = static_cast<float>(radius);
    if (round)
    {
      addTube(mesh, {0, 0, -0.05F}, {0, 0, height}, r, r, 16, Material::concrete);
    }
    else
    {
      addBox(mesh, {0, 0, 0.5F * height}, {1.7F * r, 1.7F * r, height}, Material::concrete);
    }
    const int column = world_.addShape(std::move(mesh));
    for (int i = 1; i < plan_.bays; ++i)
    {
      for (int j = -plan_.bays_below; j < plan_.bays_above; ++j)
      {
        const P where(hall.floor.low.x() + i * plan_.bay_x, (j + 0.5) * plan_.bay_y);
        world_.placeOnGround(column, where, 0);
        world_.floor_plan.block(Rect{where, where}.grown(radius));
      }
    }
  }

  /** The node at a position, which is added if there is none. */
  int nodeAt(const P& position)
  {
    for (std::size_t i = 0; i < world_.walks.nodes.size(); ++i)
    {
      if ((world_.walks.nodes[i] - position).norm() < 0.05)
      {
        return static_cast<int>(i);
      }
    }
    return world_.walks.addNode(position);
  }

  double distanceToEgo(const P& p) const
  {
    double least = 1e9;
    for (const P& q : world_.ego_path.points())
    {
      least = std::min(least, (p - q).norm());
    }
    return least;
  }

  /** Ways from bay to bay of the hall, of which some stay free for what stands there. */
  void addHallWalks()
  {
    const auto index = [&](int i, int j)
    { return static_cast<std::size_t>((j + plan_.bays_below) * plan_.bays + i); };
    const int rows = 1 + plan_.bays_above + plan_.bays_below;
    std::vector<int> nodes(static_cast<std::size_t>(rows * plan_.bays), -1);
    for (int j = -plan_.bays_below; j <= plan_.bays_above; ++j)
    {
      for (int i = 0; i < plan_.bays; ++i)
      {
        const P centre = plan_.bayCentre(i, j);
        const bool drawn = rng_.chance(0.6);
        if (drawn || j == 0 || distanceToEgo(centre) < 1)
        {
          nodes[index(i, j)] = nodeAt(centre);
        }
      }
    }
    const auto link = [&](int a, int b)
    {
      if (a >= 0 && b >= 0 &&
          world_.floor_plan.isClear(world_.walks.nodes[static_cast<std::size_t>(a)],
                                    world_.walks.nodes[static_cast<std::size_t>(b)], 1.0))
      {
        world_.walks.addLink(a, b, false, 2.6);
      }
    };
    for (int j = -plan_.bays_below; j <= plan_.bays_above; ++j)
    {
      for (int i = 0; i < plan_.bays; ++i)
      {
        if (i + 1 < plan_.bays)
        {
          link(nodes[index(i, j)], nodes[index(i + 1, j)]);
        }
        if (j < plan_.bays_above)
        {
          link(nodes[index(i, j)], nodes[index(i, j + 1)]);
        }
      }
    }
    hall_nodes_ = world_.walks.nodes.size();
  }

  /** Ways along the corridors, with a node before each door. */
  void addCorridorWalks()
  {
    const P first = plan_.bayCentre(0, 0), last = plan_.bayCentre(plan_.bays - 1, 0);
    const double a = plan_.a, b = plan_.b;
    const std::vector<std::pair<P, P>> lines{
        {{0, 0}, first}, {last, {a, 0}}, {{0, b}, {a, b}}, {{0, 0}, {0, b}}, {{a, 0}, {a, b}}};
    for (std::size_t k = 0; k < lines.size(); ++k)
    {
      const auto& [from, to] = lines[k];
      const P along = (to - from).normalized();
      const double length = (to - from).norm();
      std::vector<double> stops{0, length};
      for (const RoomDoor& door : plan_.doors)
      {
        if (door.host == static_cast<int>(k) + 1)
        {
          stops.push_back(std::clamp((door.inside - from).dot(along), 0.0, length));
        }
      }
      std::sort(stops.begin(), stops.end());
      const P size = plan_.spaces[k + 1].floor.size();
      const double width = (std::abs(along.x()) > 0.5 ? size.y() : size.x()) - 1.4;
      int previous = nodeAt(from);
      for (const double s : stops)
      {
        const int node = nodeAt(from + s * along);
        if (node != previous)
        {
          world_.walks.addLink(previous, node, false, width);
        }
        previous = node;
      }
    }
  }

  void addDoors()
  {
    for (const RoomDoor& door : plan_.doors)
    {
      int before = -1;
      double nearest = 1e9;
      const std::size_t begin = door.host == 0 ? 0 : hall_nodes_;
      const std::size_t end = door.host == 0 ? hall_nodes_ : world_.walks.nodes.size();
      for (std::size_t i = begin; i < end; ++i)
      {
        const P& node = world_.walks.nodes[i];
        const double distance = (node - door.inside).norm();
        if (distance < nearest && world_.floor_plan.isClear(node, door.inside, 0.35))
        {
          nearest = distance;
          before = static_cast<int>(i);
        }
      }
      if (before >= 0)
      {
        ends_.emplace_back(before, door.inside);
      }
    }
    for (const auto& [before, inside] : ends_)
    {
      world_.walks.addLink(before, world_.walks.addNode(inside), false, 0.8);
    }
  }

  void reserveWays()
  {
    for (const auto& link : world_.walks.links)
    {
      const P& a = world_.walks.nodes[static_cast<std::size_t>(link.a)];
      const P& b = world_.walks.nodes[static_cast<std::size_t>(link.b)];
      world_.floor_plan.reserve(a, b, std::max(0.6, 0.5 * link.width));
    }
    const auto& points = world_.ego_path.points();
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
    {
      world_.floor_plan.reserve(points[i], points[i + 1], 1.1);
    }
    for (const RoomDoor& door : plan_.doors)  // also of rooms that no way leads to
    {
      world_.floor_plan.reserve(door.before, door.inside, door.half_width);
    }
  }

  World& world_;
  const IndoorPlan& plan_;
  Rng& rng_;
  std::size_t hall_nodes_ = 0;
  std::vector<std::pair<int, P>> ends_;  // ways into rooms
};
}  // namespace

void buildIndoor(World& world, const SimulatorOptions& options)
{
  if (options.ego == EgoKind::car)
  {
    throw UserError("simulator.ego: a car does not fit indoors; choose robot or handheld");
  }
  if (options.loop_length < 150 || options.loop_length > 600)
  {
    throw UserError("simulator.loop_length: indoors a loop has 150 to 600 m");
  }
  Rng rng(combine(world.seed, 0x1D004));
  addIndoorBodies(world, rng);
  const IndoorPlan plan(rng, options.loop_length);
  IndoorBuilder(world, plan, rng).build();
}
}  // namespace dyslam::sim
