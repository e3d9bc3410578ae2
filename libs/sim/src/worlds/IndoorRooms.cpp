// SPDX-License-Identifier: BSD-3-Clause
// Walls, ceilings and furniture of an indoor world.
#include <algorithm>
#include <cmath>
#include <utility>

#include "Indoor.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;
using V = Eigen::Vector3f;
using Interval = std::pair<double, double>;

/** Point on a side of a room. \param out distance beyond the wall; below 0: in the room [m] */
V pointOf(const RoomSide& side, double along, double out, double z)
{
  const P p = side.point(along, out);
  return Eigen::Vector3d(p.x(), p.y(), z).cast<float>();
}

/** Rotation that turns +y to the outward direction of a side. */
double yawOf(const RoomSide& side)
{
  return side.along_x ? (side.outward > 0 ? 0.0 : M_PI) : (side.outward > 0 ? -M_PI_2 : M_PI_2);
}

/** The pieces of a side without an opening. */
std::vector<Interval> closedPieces(const RoomSide& side, const std::vector<Opening>& openings)
{
  std::vector<Interval> holes;
  for (const Opening& o : openings)
  {
    if (o.along_x == side.along_x &&
        std::min(std::abs(o.first - side.at), std::abs(o.second - side.at)) < 1e-6 &&
        o.high > side.low && o.low < side.high)
    {
      holes.emplace_back(o.low, o.high);
    }
  }
  std::sort(holes.begin(), holes.end());
  std::vector<Interval> pieces;
  double s = side.low;
  for (const Interval& hole : holes)
  {
    if (hole.first > s + 1e-6)
    {
      pieces.emplace_back(s, hole.first);
    }
    s = std::max(s, hole.second);
  }
  if (side.high > s + 1e-6)
  {
    pieces.emplace_back(s, side.high);
  }
  return pieces;
}

class WallBuilder
{
 public:
  WallBuilder(World& world, const IndoorPlan& plan, Rng& rng)
      : world_(world), plan_(plan), rng_(rng), mesh_(world.meshes.emplace_back())
  {
  }

  void build()
  {
    for (const Space& space : plan_.spaces)
    {
      for (const RoomSide& side : sidesOf(space.floor))
      {
        wall(space, side);
      }
      ceiling(space);
    }
    for (const Opening& o : plan_.openings)
    {
      reveal(o);
      if (o.glass)
      {
        glassFront(o);
      }
    }
  }

 private:
  void quad(const RoomSide& side, const Interval& s, double z0, double z1, Material material)
  {
    mesh_.addQuad(pointOf(side, s.first, 0, z0), pointOf(side, s.second, 0, z0),
                  pointOf(side, s.second, 0, z1), pointOf(side, s.first, 0, z1), material);
  }

  /** A box at a wall. \param s its middle \param z its lower edge \param size along the wall, out
   * of it, and up [m] */
  void box(const RoomSide& side, double s, double z, const Eigen::Vector3d& size, Material material)
  {
    const P p = side.point(s, -0.5 * size.y());
    const Eigen::Vector3d extent =
        side.along_x ? size : Eigen::Vector3d(size.y(), size.x(), size.z());
    addBox(mesh_, Eigen::Vector3d(p.x(), p.y(), z + 0.5 * size.z()).cast<float>(),
           extent.cast<float>(), material);
    if (z < 1 && size.y() > 0.07)
    {
      const P half = 0.5 * extent.head<2>();
      world_.floor_plan.block({p - half, p + half});
    }
  }

  void wall(const Space& space, const RoomSide& side)
  {
    for (const Interval& piece : closedPieces(side, plan_.openings))
    {
      quad(side, piece, 0, space.height, Material::inner_wall);
      clutter(space, side, piece);
    }
    for (const Opening& o : plan_.openings)  // the wall above
    {
      if (o.along_x == side.along_x &&
          std::min(std::abs(o.first - side.at), std::abs(o.second - side.at)) < 1e-6 &&
          o.high > side.low && o.low < side.high && o.height < space.height - 1e-6)
      {
        quad(side, {std::max(o.low, side.low), std::min(o.high, side.high)}, o.height, space.height,
             Material::inner_wall);
        if (space.kind != Space::Kind::office && space.kind != Space::Kind::shop &&
            std::abs(o.first - side.at) < 1e-6 && o.high - o.low > 3 && o.first != o.second)
        {
          box(side, 0.5 * (o.low + o.high), o.height + 0.05,
              {0.8 * (o.high - o.low), 0.15, std::min(0.5, space.height - o.height - 0.1)},
              Material::furniture);  // the sign of a shop
        }
      }
    }
    if (space.kind == Space::Kind::hall)
    {
      upperWall(space, side);
    }
  }

  /** Pilasters and windows of the hall above the shops. */
  void upperWall(const Space& space, const RoomSide& side)
  {
    const double pitch = side.along_x ? plan_.bay_x : plan_.bay_y;
    for (double s = side.low + pitch; s < side.high - 0.5 * pitch; s += pitch)
    {
      box(side, s, 3.6, {0.5, 0.25, space.height - 3.6}, Material::concrete);
    }
    for (double s = side.low + 0.5 * pitch; s < side.high; s += pitch)
    {
      const double width = 0.6 * pitch, height = space.height - 5.5;
      box(side, s, 4.3, {width, 0.03, height}, Material::window);
      box(side, s, 4.2, {width + 0.2, 0.12, 0.1}, Material::inner_wall);
    }
    box(side, 0.5 * (side.low + side.high), 3.5, {side.high - side.low, 0.18, 0.15},
        Material::inner_wall);
  }

  /** What is on a piece of wall. */
  void clutter(const Space& space, const RoomSide& side, const Interval& piece)
  {
    double s = piece.first + rng_.uniform(0.2, 1.0);
    while (s < piece.second - 0.5)
    {
      const double room = piece.second - s;
      const double u = rng_.uniform();
      if (u < 0.2)
      {
        box(side, s + 0.2, 0, {0.35, rng_.uniform(0.08, 0.2), space.height}, Material::concrete);
        s += 0.5;
      }
      else if (u < 0.4 && room > 1.3)
      {
        closedDoor(side, s + 0.6);
        s += 1.3;
      }
      else if (u < 0.55 && room > 1.6)
      {
        const double width = rng_.uniform(0.6, 1.4), height = rng_.uniform(0.6, 1.2);
        box(side, s + 0.5 * width, 1.0, {width, 0.05, height}, Material::sign_face);
        s += width + 0.2;
      }
      else if (u < 0.7)
      {
        box(side, s + 0.1, 0.3, {0.16, 0.16, 0.6}, Material::furniture);  // fire extinguisher
        box(side, s + 0.1, 1.5, {0.3, 0.02, 0.3}, Material::sign_face);
        s += 0.6;
      }
      else if (u < 0.85 && room > 1.5)
      {
        box(side, s + 0.6, 0.15, {rng_.uniform(0.8, 1.2), 0.12, 0.6}, Material::steel);  // radiator
        s += 1.4;
      }
      else
      {
        box(side, s + 0.1, 0, {0.08, 0.08, space.height}, Material::steel);  // pipe
        s += 0.3;
      }
      s += rng_.uniform(0.3, space.kind == Space::Kind::corridor ? 2.2 : 3.5);
    }
  }

  void closedDoor(const RoomSide& side, double s)
  {
    for (const double end : {-0.5, 0.5})
    {
      box(side, s + end, 0, {0.08, 0.06, 2.1}, Material::steel);
    }
    box(side, s, 2.08, {1.08, 0.06, 0.08}, Material::steel);
    box(side, s, 0, {0.92, 0.03, 2.05}, Material::furniture);
    box(side, s + 0.4, 1.0, {0.14, 0.07, 0.04}, Material::steel);
  }

  /** The inside of an opening, between the walls of the two rooms. */
  void reveal(const Opening& o)
  {
    if (std::abs(o.first - o.second) < 1e-6)
    {
      return;
    }
    const RoomSide side{o.along_x, o.first, o.low, o.high, o.second > o.first ? 1.0 : -1.0};
    const double t = std::abs(o.second - o.first);
    for (const double s : {o.low, o.high})
    {
      mesh_.addQuad(pointOf(side, s, 0, 0), pointOf(side, s, t, 0), pointOf(side, s, t, o.height),
                    pointOf(side, s, 0, o.height), Material::inner_wall);
    }
    mesh_.addQuad(pointOf(side, o.low, 0, o.height), pointOf(side, o.high, 0, o.height),
                  pointOf(side, o.high, t, o.height), pointOf(side, o.low, t, o.height),
                  Material::inner_wall);
  }

  /** Panes let all beams pass; their frames, sills and the stripes that mark them do not. */
  void glassFront(const Opening& o)
  {
    const RoomSide side{o.along_x, o.first, o.low, o.high, o.second > o.first ? 1.0 : -1.0};
    const double middle = 0.5 * (o.low + o.high), door = 0.95;
    for (const Interval& part : {Interval{o.low, middle - door}, Interval{middle + door, o.high}})
    {
      const double length = part.second - part.first, centre = 0.5 * (part.first + part.second);
      if (length < 0.2)
      {
        continue;
      }
      box(side, centre, 0, {length, 0.08, 0.15}, Material::steel);
      box(side, centre, o.height - 0.1, {length, 0.06, 0.1}, Material::steel);
      box(side, centre, 1.0, {length, 0.01, 0.06}, Material::sign_face);
      box(side, centre, 1.5, {length, 0.01, 0.06}, Material::sign_face);
      const int panes = std::max(1, static_cast<int>(std::lround(length / 1.4)));
      for (int i = 0; i <= panes; ++i)
      {
        box(side, part.first + length * i / panes, 0, {0.06, 0.08, o.height}, Material::steel);
      }
    }
  }

  void ceiling(const Space& space)
  {
    const V
        low = Eigen::Vector3d(space.floor.low.x(), space.floor.low.y(), space.height).cast<float>(),
        high =
            Eigen::Vector3d(space.floor.high.x(), space.floor.high.y(), space.height).cast<float>();
    mesh_.addQuad(low, V(high.x(), low.y(), low.z()), high, V(low.x(), high.y(), low.z()),
                  Material::inner_wall);
    const bool along_x = space.floor.size().x() > space.floor.size().y();
    if (space.kind == Space::Kind::hall)
    {
      hallCeiling(space);
    }
    else
    {
      lamps(space, along_x);
    }
    if (space.kind == Space::Kind::corridor)
    {
      corridorCeiling(space, along_x);
    }
  }

  /** A box below the ceiling. \param along, across of the room's axis [m] */
  void hang(const Space& space,
            bool along_x,
            double along,
            double across,
            double top,
            const Eigen::Vector3d& size,
            Material material)
  {
    const P p = along_x ? P(along, across) : P(across, along);
    const Eigen::Vector3d extent = along_x ? size : Eigen::Vector3d(size.y(), size.x(), size.z());
    addBox(mesh_, Eigen::Vector3d(p.x(), p.y(), space.height - top - 0.5 * size.z()).cast<float>(),
           extent.cast<float>(), material);
  }

  void lamps(const Space& space, bool along_x)
  {
    const Rect& f = space.floor;
    const double low = along_x ? f.low.x() : f.low.y(), high = along_x ? f.high.x() : f.high.y();
    const double middle = along_x ? f.centre().y() : f.centre().x();
    const double pitch = rng_.uniform(2.4, 4);
    for (double s = low + 0.5 * pitch; s < high - 0.7; s += pitch)
    {
      hang(space, along_x, s, middle, 0, {1.2, 0.3, 0.08}, Material::furniture);
    }
  }

  void corridorCeiling(const Space& space, bool along_x)
  {
    const Rect& f = space.floor;
    const double low = along_x ? f.low.x() : f.low.y(), high = along_x ? f.high.x() : f.high.y();
    const double c0 = along_x ? f.low.y() : f.low.x(), c1 = along_x ? f.high.y() : f.high.x();
    const double middle = 0.5 * (c0 + c1), width = c1 - c0;
    for (double s = low + rng_.uniform(2, 6); s < high - 1; s += rng_.uniform(6, 12))
    {
      hang(space, along_x, s, middle, 0, {0.3, width, rng_.uniform(0.2, 0.35)},
           Material::inner_wall);  // beam
    }
    for (double s = low + rng_.uniform(5, 12); s < high - 2; s += rng_.uniform(14, 25))
    {
      hang(space, along_x, s, middle, 0.35, {0.1, rng_.uniform(1.2, 2), 0.35},
           Material::sign_face);  // guide sign
    }
    if (high - low > 5)
    {
      const double side = rng_.chance(0.5) ? c0 + 0.5 : c1 - 0.5;
      hang(space, along_x, 0.5 * (low + high), side, 0.05, {high - low - 1, 0.35, 0.25},
           Material::steel);  // duct
    }
  }

  void hallCeiling(const Space& space)
  {
    const Rect& f = space.floor;
    const double depth = rng_.uniform(0.6, 1.0);
    for (int i = 0; i <= plan_.bays; ++i)
    {
      hang(space, true, f.low.x() + i * plan_.bay_x, f.centre().y(), 0, {0.4, f.size().y(), depth},
           Material::concrete);
    }
    for (int j = -plan_.bays_below; j <= plan_.bays_above; ++j)
    {
      hang(space, true, f.centre().x(), (j + 0.5) * plan_.bay_y, 0.1,
           {f.size().x(), 0.3, 0.6 * depth}, Material::concrete);
      for (int i = 0; i < plan_.bays; ++i)
      {
        hang(space, true, plan_.bayCentre(i, j).x(), j * plan_.bay_y, 1.5, {0.5, 0.5, 0.3},
             Material::furniture);  // lamp
      }
    }
  }

  World& world_;
  const IndoorPlan& plan_;
  Rng& rng_;
  Mesh& mesh_;
};

/** A shape with its footprint. */
struct Item
{
  int shape = 0;
  P half = P::Zero();  //!< half of its extent along x and y [m]
};

class Furnisher
{
 public:
  Furnisher(World& world, const IndoorPlan& plan, Rng& rng) : world_(world), plan_(plan), rng_(rng)
  {
    for (int i = 0; i < 4; ++i)
    {
      shelves_.push_back(
          item(makeShelf(rng, rng.uniformFloat(1.5, 3), 0.45F, i == 3 ? 1.3F : 2.0F)));
      racks_.push_back(
          item(makePalletRack(rng, 2.7F + 2.7F * static_cast<float>(i % 2), i < 2 ? 2.5F : 2.2F)));
      plants_.push_back(item(makePotPlant(rng, rng.uniformFloat(0.7, 1.4))));
    }
    clothes_ = item(makeClothesRack(rng, 1.6F));
    goods_ = item(makeGoodsPile(rng, 1.8F, 0.9F));
    bench_ = item(makeBench());
    bin_ = item(makeBin());
    vending_ = item(makeVendingMachine());
    board_ = item(makeAdvertisingBoard());
    counter_ = item(makeCounter(3));
    kiosk_ = item(makeKiosk(4, 3));
    desk_ = item(makeDesk());
    cupboard_ = item(makeCupboard(1.5F, 1.9F));
  }

  void furnish()
  {
    for (const Space& space : plan_.spaces)
    {
      switch (space.kind)
      {
        case Space::Kind::hall:
          hall(space);
          break;
        case Space::Kind::corridor:
          alongWalls(space, {bench_, bin_, vending_, board_, plants_[0], plants_[1], cupboard_},
                     0.07);
          break;
        case Space::Kind::shop:
          alongWalls(space, shelves_, 0.5);
          rows(space, rng_.chance(0.5) ? shelves_ : std::vector<Item>{clothes_, goods_}, 2.2);
          break;
        case Space::Kind::office:
          alongWalls(space, {desk_, cupboard_, desk_, plants_[2]}, 0.4);
          break;
        case Space::Kind::store:
          rows(space, racks_, 3.4);
          alongWalls(space, {goods_, cupboard_}, 0.2);
          break;
      }
    }
  }

 private:
  Item item(Mesh mesh)
  {
    const Eigen::AlignedBox3f box = mesh.bounds();
    const V half = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
    return {world_.addShape(std::move(mesh)), half.head<2>().cast<double>()};
  }

  /** Places an item if the floor is free there. \param yaw a multiple of a right angle */
  bool put(const Item& what, const P& where, double yaw)
  {
    const bool turned = std::abs(std::sin(yaw)) > 0.5;
    const P half = turned ? P(what.half.y(), what.half.x()) : what.half;
    const Rect footprint{where - half, where + half};
    if (!world_.floor_plan.available(footprint.grown(0.02)))
    {
      return false;
    }
    world_.floor_plan.block(footprint);
    world_.placeOnGround(what.shape, where, yaw);
    return true;
  }

  /** \param per_metre expected number of items on each metre of wall */
  void alongWalls(const Space& space, const std::vector<Item>& items, double per_metre)
  {
    for (const RoomSide& side : sidesOf(space.floor))
    {
      const int attempts = static_cast<int>(std::ceil((side.high - side.low) * per_metre));
      for (int k = 0; k < attempts; ++k)
      {
        const Item& what = rng_.pick(items);
        const double s = rng_.uniform(side.low, side.high);
        put(what, side.point(s, -what.half.y() - rng_.uniform(0.04, 0.25)), yawOf(side));
      }
    }
  }

  /** Rows of items in a room, parallel to its longer side. \param pitch distance of the rows [m] */
  void rows(const Space& space, const std::vector<Item>& items, double pitch)
  {
    const bool along_x = space.floor.size().x() > space.floor.size().y();
    const Rect inner = space.floor.grown(-1.4);
    const double u0 = along_x ? inner.low.x() : inner.low.y(),
                 u1 = along_x ? inner.high.x() : inner.high.y();
    const double v0 = along_x ? inner.low.y() : inner.low.x(),
                 v1 = along_x ? inner.high.y() : inner.high.x();
    for (double v = v0; v < v1; v += pitch)
    {
      double u = u0;
      while (u < u1)
      {
        const Item& what = rng_.pick(items);
        u += what.half.x();
        if (u + what.half.x() < u1)
        {
          put(what, along_x ? P(u, v) : P(v, u), along_x ? 0 : M_PI_2);
        }
        u += what.half.x() + 0.02;
      }
    }
  }

  void hall(const Space& space)
  {
    alongWalls(space, {bench_, vending_, board_, bin_, plants_[3], counter_}, 0.12);
    // Counters with a queue
    for (int k = 0; k < 400 && world_.queues.size() < 4; ++k)
    {
      const int i = rng_.below(plan_.bays),
                j = rng_.below(1 + plan_.bays_above + plan_.bays_below) - plan_.bays_below;
      const double y = rng_.uniform(-0.4, 0.4) * plan_.bay_y,
                   x = rng_.uniform(-0.4, 0.4) * plan_.bay_x;
      const P where = plan_.bayCentre(i, j) + P(x, y);
      const bool kiosk = rng_.chance(0.5);
      const Item& what = kiosk ? kiosk_ : counter_;
      const int places = 4 + rng_.below(5);
      const double direction = rng_.chance(0.5) ? 1 : -1;
      // The queue begins in front of the counter and bends along it.
      const P head = where - P(0, what.half.y() + 0.55);
      const P tail = head + P(direction * 0.85 * places, 0);
      const Rect line{head.cwiseMin(tail) - P(0.4, 0.4), head.cwiseMax(tail) + P(0.4, 0.4)};
      if (world_.floor_plan.available(line) && put(what, where, 0))
      {
        world_.queues.push_back({head, P(direction, 0), places});
        world_.floor_plan.reserve(head, tail, 0.45);
      }
    }
    for (int k = 0; k < 3 * plan_.bays; ++k)
    {
      const double y = rng_.uniform(space.floor.low.y() + 1.5, space.floor.high.y() - 1.5),
                   x = rng_.uniform(space.floor.low.x() + 1.5, space.floor.high.x() - 1.5);
      const double u = rng_.uniform();
      const double yaw = rng_.below(4) * M_PI_2;
      put(u < 0.35   ? bench_
          : u < 0.5  ? plants_[static_cast<std::size_t>(rng_.below(4))]
          : u < 0.65 ? board_
          : u < 0.8  ? bin_
                     : goods_,
          {x, y}, yaw);
    }
  }

  World& world_;
  const IndoorPlan& plan_;
  Rng& rng_;
  std::vector<Item> shelves_, racks_, plants_;
  Item clothes_, goods_, bench_, bin_, vending_, board_, counter_, kiosk_, desk_, cupboard_;
};
}  // namespace

void addWalls(World& world, const IndoorPlan& plan, Rng& rng)
{
  WallBuilder(world, plan, rng).build();
}

void addFurniture(World& world, const IndoorPlan& plan, Rng& rng)
{
  Furnisher(world, plan, rng).furnish();
}
}  // namespace dyslam::sim
