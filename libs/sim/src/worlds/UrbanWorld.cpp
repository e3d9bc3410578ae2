// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "BlockSide.h"
#include "Random.h"
#include "StreetGrid.h"
#include "World.h"
#include "shapes/Building.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

/** Shapes of street furniture and plants, registered once per world. */
struct Furnishing
{
  std::vector<int> trees, small_trees, bushes, hedges, signs, fences, clutter;
  int lamp = 0, light = 0, bus_stop = 0, bollard = 0, bench = 0;

  Furnishing(World& world, Rng& rng)
  {
    const auto in = [&](double a, double b) { return static_cast<float>(rng.uniform(a, b)); };
    for (int i = 0; i < 4; ++i)
    {
      trees.push_back(world.addShape(drawTree(rng, {7, 12}, {1.8, 3.4}, {2.2, 3.2})));
      small_trees.push_back(world.addShape(i == 3 ? drawConifer(rng, {5, 9}, {1.3, 2})
                                                  : drawTree(rng, {3.5, 6}, {1, 1.9}, {1.2, 2})));
      bushes.push_back(world.addShape(drawBush(rng, {0.5, 1.2}, {0.7, 1.6})));
      signs.push_back(world.addShape(makeSign(i)));
    }
    for (int i = 0; i < 3; ++i)
    {
      const float height = in(0.9, 1.8), width = in(0.6, 1.0);
      hedges.push_back(world.addShape(makeHedge(rng, 3.0F, width, height)));
    }
    for (int i = 0; i < 4; ++i)
    {
      fences.push_back(world.addShape(makeFence(i, 3.0F, in(0.9, 1.5))));
    }
    clutter = {world.addShape(makeBin()), world.addShape(makeCabinet()),
               world.addShape(makeBollard())};
    const float arm = in(0.6, 1.6);
    lamp = world.addShape(makeLampPost(in(5, 8.5), arm));
    light = world.addShape(makeTrafficLight());
    bus_stop = world.addShape(makeBusStop());
    bollard = clutter[2];
    bench = world.addShape(makeBench());
  }
};

class BlockBuilder
{
 public:
  BlockBuilder(World& world, const StreetGrid& grid, Rng& rng)
      : world_(world), grid_(grid), rng_(rng), furnishing_(world, rng)
  {
  }

  void build(int i, int j)
  {
    const auto e = grid_.blockInside(i, j);
    const P sw(e[0], e[1]);
    const double width = e[2] - e[0], height = e[3] - e[1];
    const int character = rng_.below(10);
    const bool belt = i < 0 || j < 0 || i + 1 >= static_cast<int>(grid_.along_v.size()) ||
                      j + 1 >= static_cast<int>(grid_.along_u.size());
    if (character == 0 && !belt)
    {
      park(sw, width, height);
      return;
    }
    const bool dense = character < 5;
    const double depth = dense ? 14 : 20;
    for (const Side& one : blockSides(grid_, i, j, depth))
    {
      side(one, dense);
    }
    scatter(sw + P(depth, depth), width - 2 * depth, height - 2 * depth, 12);
  }

  /** Parked cars and the furniture of the pavements. */
  void street(const Street& street, bool runs_along_v, double from, double to)
  {
    for (const double side : {-1.0, 1.0})
    {
      const Kerb kerb{street, runs_along_v, side};
      parkCars(kerb, from, to);
      furnishPavement(kerb, from, to);
    }
  }

  void junction(const Street& a, const Street& b)
  {
    const bool lights = rng_.chance(0.4);
    for (const double su : {-1.0, 1.0})
    {
      for (const double sv : {-1.0, 1.0})
      {
        const P where(a.centre + su * (a.half() + 0.6), b.centre + sv * (b.half() + 2.0));
        const double turned = rng_.uniform(0, 6.28);
        world_.placeOnGround(lights ? furnishing_.light : rng_.pick(furnishing_.signs),
                             grid_.toWorld(where), turned);
      }
    }
  }

 private:
  double heading(const P& local, bool along_v) const
  {
    return grid_.headingOfU(local) + (along_v ? 1.5707963 : 0.0);
  }

  void parkCars(const Kerb& kerb, double from, double to)
  {
    const Street& street = kerb.street;
    if (street.parking <= 0)
    {
      return;
    }
    for (double s = from + rng_.uniform(0, 6); s < to; s += rng_.uniform(5.8, 7.0))
    {
      if (!kerb.isClear(grid_, s, 7.0) || !rng_.chance(street.occupancy))
      {
        continue;
      }
      const int model = rng_.chance(0.9) ? rng_.pick(world_.cars) : rng_.pick(world_.vans);
      const P where =
          kerb.at(s, street.carriageway() + 0.5 * street.parking + rng_.uniform(0, 0.1));
      const bool ahead = rng_.chance(0.85) == (kerb.side > 0);
      const double yaw =
          heading(where, kerb.along_v) + (ahead ? 0 : 3.14159265) + rng_.uniform(-0.03, 0.03);
      world_.park(model, grid_.toWorld(where), yaw, rng_);
    }
  }

  /** Lamps on one side, trees, and smaller things between them. */
  void furnishPavement(const Kerb& kerb, double from, double to)
  {
    double next_lamp = from + rng_.uniform(3, 20), next_tree = from + rng_.uniform(2, 12);
    const double at_kerb = kerb.street.half() + 0.45;  // distance from the centre line [m]
    for (double s = from; s < to; s += 1.0)
    {
      if (!kerb.isClear(grid_, s, 2.5))
      {
        continue;
      }
      const P where = kerb.at(s, at_kerb);
      const double yaw = heading(where, kerb.along_v) + (kerb.side > 0 ? 0 : 3.14159265);
      if (s >= next_lamp && kerb.side > 0)
      {
        next_lamp = s + rng_.uniform(22, 32);
        world_.placeOnGround(furnishing_.lamp, grid_.toWorld(where), yaw);
      }
      else if (kerb.street.trees && s >= next_tree)
      {
        next_tree = s + rng_.uniform(6, 14);
        const auto scale = static_cast<float>(rng_.uniform(0.8, 1.15));
        const double turned = rng_.uniform(0, 6.28);
        world_.placeOnGround(rng_.pick(furnishing_.trees), grid_.toWorld(kerb.at(s, at_kerb + 0.5)),
                             turned, scale);
      }
      else
      {
        placeOnPavement(kerb, s, at_kerb, yaw);
      }
    }
  }

  /** A sign, a bin, a bush, a bicycle or a bus stop, or mostly nothing. \param yaw heading of the
   * street with the kerb on the right [rad] */
  void placeOnPavement(const Kerb& kerb, double s, double at_kerb, double yaw)
  {
    const double at_wall = kerb.street.half() + kerb.street.walk;
    const auto place = [&](int shape, double d, double turned, float scale = 1)
    { world_.placeOnGround(shape, grid_.toWorld(kerb.at(s, d)), turned, scale); };
    if (rng_.chance(0.02))
    {
      place(rng_.pick(furnishing_.signs), at_kerb, yaw + 3.14159265);
    }
    else if (rng_.chance(0.05))
    {
      place(rng_.pick(furnishing_.clutter), at_wall - 0.5, yaw);
    }
    else if (rng_.chance(0.03))
    {
      const double turned = rng_.uniform(0, 6.28);
      place(rng_.pick(furnishing_.bushes), at_wall - 0.35, turned, 0.6F);
    }
    else if (rng_.chance(0.02))
    {
      const double turned = yaw + rng_.uniform(-0.3, 0.3);
      world_.park(rng_.pick(world_.parked_bicycles), grid_.toWorld(kerb.at(s, at_wall - 0.4)),
                  turned, rng_);
    }
    else if (rng_.chance(0.003))
    {
      place(furnishing_.bus_stop, at_kerb + 0.6, yaw);
    }
  }

  void side(const Side& side, bool dense)
  {
    double s = dense ? 0 : rng_.uniform(1, 4);
    while (s < side.length - 6)
    {
      BuildingStyle style = dense ? drawTownHouse(rng_) : drawHouse(rng_);
      style.width = static_cast<float>(std::min(static_cast<double>(style.width), side.length - s));
      style.depth = static_cast<float>(
          std::min(static_cast<double>(style.depth), side.depth - (dense ? 0.5 : 12)));
      const double front =
          dense ? (rng_.chance(0.5) ? 0.05 : rng_.uniform(0.2, 4.0)) : rng_.uniform(4.5, 12);
      const double width = static_cast<double>(style.width);
      if (dense && rng_.chance(0.12))
      {
        furnishGap(side, s, width);  // a gap between houses
      }
      else
      {
        addHouse(side, s, front, style);
        if (!dense)
        {
          garden(side, s, width, front);
        }
      }
      s += width + (dense ? (rng_.chance(0.2) ? rng_.uniform(1.5, 4) : 0.0) : rng_.uniform(3, 8));
    }
  }

  void addHouse(const Side& side, double s, double front, const BuildingStyle& style)
  {
    const auto frame = houseFrame(grid_, side, s, front, static_cast<double>(style.width),
                                  static_cast<double>(style.depth));
    addBuilding(world_.meshes.back(), style, frame, rng_);
  }

  /** A row of 3 m elements along a side of a block. */
  void row(const Side& side, double s, double length, double front, int shape)
  {
    for (double x = 0; x + 3 <= length + 0.5; x += 3)
    {
      const P a = grid_.toWorld(side.at(s + x, front)),
              b = grid_.toWorld(side.at(s + x + 3, front));
      world_.placeOnGround(shape, a, std::atan2(b.y() - a.y(), b.x() - a.x()));
    }
  }

  void garden(const Side& side, double s, double width, double front)
  {
    const double u = rng_.uniform();
    if (u < 0.75)
    {
      row(side, s - 1, width + 2, 0.4,
          u < 0.4 ? rng_.pick(furnishing_.hedges) : rng_.pick(furnishing_.fences));
    }
    const int plants = rng_.below(18);
    for (int k = 0; k < plants; ++k)
    {
      const double inward = rng_.uniform(1.2, std::max(1.3, front - 0.8));
      const P where = side.at(s + rng_.uniform(0, width), inward);
      const double turned = rng_.uniform(0, 6.28);
      world_.placeOnGround(
          rng_.chance(0.6) ? rng_.pick(furnishing_.bushes) : rng_.pick(furnishing_.small_trees),
          grid_.toWorld(where), turned);
    }
    if (rng_.chance(0.4) && front > 5)
    {
      const P a = grid_.toWorld(side.at(s + width + 1.5, 1)),
              b = grid_.toWorld(side.at(s + width + 1.5, 5));
      world_.park(rng_.pick(world_.cars), 0.5 * (a + b), std::atan2(b.y() - a.y(), b.x() - a.x()),
                  rng_);
    }
  }

  void furnishGap(const Side& side, double s, double width)
  {
    row(side, s, width, 0.4, rng_.pick(furnishing_.fences));
    for (int k = 0; k < 4; ++k)
    {
      const double turned = rng_.uniform(0, 6.28);
      const double inward = rng_.uniform(2, side.depth);
      const P where = side.at(s + rng_.uniform(0, width), inward);
      world_.placeOnGround(
          rng_.pick(rng_.chance(0.5) ? furnishing_.bushes : furnishing_.small_trees),
          grid_.toWorld(where), turned);
    }
  }

  void scatter(const P& corner, double width, double height, int count)
  {
    for (int k = 0; k < count && width > 4 && height > 4; ++k)
    {
      const double y = rng_.uniform(0, height), x = rng_.uniform(0, width);
      const double turned = rng_.uniform(0, 6.28);
      world_.placeOnGround(
          rng_.pick(rng_.chance(0.5) ? furnishing_.trees : furnishing_.small_trees),
          grid_.toWorld(corner + P(x, y)), turned);
    }
  }

  void park(const P& corner, double width, double height)
  {
    scatter(corner + P(2, 2), width - 4, height - 4, static_cast<int>(width * height / 110));
    for (int k = 0; k < 10; ++k)
    {
      const double y = rng_.uniform(2, height - 2), x = rng_.uniform(2, width - 2);
      const double turned = rng_.uniform(0, 6.28);
      world_.placeOnGround(rng_.chance(0.5) ? rng_.pick(furnishing_.bushes) : furnishing_.bench,
                           grid_.toWorld(corner + P(x, y)), turned);
    }
    const Side south{corner, P(1, 0), P(0, 1), width, height};
    row(south, 1, width - 2, 0.5,
        rng_.chance(0.5) ? rng_.pick(furnishing_.hedges) : rng_.pick(furnishing_.fences));
  }

  World& world_;
  const StreetGrid& grid_;
  Rng& rng_;
  Furnishing furnishing_;
};
}  // namespace

void buildUrban(World& world, const SimulatorOptions& options)
{
  Rng rng(combine(world.seed, 0x0B8A));
  const double block = rng.uniform(78, 105);
  const BlockRing ring = drawBlockRing(options.loop_length, block, rng);
  auto grid = std::make_unique<StreetGrid>(world.seed, ring.u + 2, ring.v + 2, block);
  const StreetGrid& streets = *grid;
  world.meshes.push_back(streets.mesh());
  world.ground = std::move(grid);
  world.meshes.emplace_back();  // all buildings
  BlockBuilder builder(world, streets, rng);
  const int nu = static_cast<int>(streets.along_v.size()),
            nv = static_cast<int>(streets.along_u.size());
  for (int i = -1; i < nu; ++i)
  {
    for (int j = -1; j < nv; ++j)
    {
      builder.build(i, j);
    }
  }
  for (const auto& s : streets.along_v)
  {
    builder.street(s, true, streets.minV(), streets.maxV());
    for (const auto& t : streets.along_u)
    {
      builder.junction(s, t);
    }
  }
  for (const auto& s : streets.along_u)
  {
    builder.street(s, false, streets.minU(), streets.maxU());
  }
  setNetworks(streets, ring, rng.chance(0.5) != options.reverse, world);
}
}  // namespace dyslam::sim
