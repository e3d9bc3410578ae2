// SPDX-License-Identifier: BSD-3-Clause
// The dense centre of an old city: narrow streets with two lanes each way, open shops, alleys,
// courtyards, stalls, and rows of parked motorcycles.
#include <algorithm>
#include <cmath>

#include "BlockSide.h"
#include "Random.h"
#include "StreetGrid.h"
#include "World.h"
#include "shapes/Shapes.h"
#include "shapes/ShopHouse.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

constexpr double kHalfTurnAngle = 3.14159265;
constexpr std::uint16_t kMotorcycle = 15;  // SemanticKITTI class

Street drawDowntownStreet(Rng& rng)
{
  Street s;
  s.lanes = rng.chance(0.75) ? 2 : 1;
  s.lane = s.lanes == 2 ? rng.uniform(3.05, 3.25) : rng.uniform(3.1, 3.8);
  s.parking = rng.chance(0.7) ? 2.2 : 0.0;
  // 14 to 26 m between the facades
  const double half = rng.uniform(std::max(7.0, s.half() + 2.4), s.lanes == 2 ? 13.0 : 10.0);
  s.walk = std::clamp(half - s.half(), 2.4, 5.5);
  s.trees = rng.chance(0.3);
  s.occupancy = rng.uniform(0.6, 1.0);
  return s;
}

/** Shapes on pavements and in yards, registered once per world. */
struct StreetShapes
{
  std::vector<int> scooters, stalls, umbrellas, goods, racks, trees, bushes, signs, fences, clutter;
  int pole = 0, lamp = 0, light = 0, bollard = 0, barrier = 0;

  StreetShapes(World& world, Rng& rng)
  {
    const auto in = [&](double a, double b) { return static_cast<float>(rng.uniform(a, b)); };
    scooters = {world.addShape(makeScooter(false))};
    for (int i = 0; i < 4; ++i)
    {
      const float length = in(1.4, 2.8), pile = in(1, 2.5), rack = in(1, 2);
      stalls.push_back(world.addShape(makeStall(rng, length, 0.85F)));
      goods.push_back(world.addShape(makeGoodsPile(rng, pile, 0.7F)));
      racks.push_back(world.addShape(makeClothesRack(rng, rack)));
      umbrellas.push_back(world.addShape(makeUmbrella(rng, in(0.8, 1.3))));
      signs.push_back(world.addShape(makeSign(i)));
      fences.push_back(world.addShape(makeFence(i, 3.0F, in(0.8, 1.5))));
      bushes.push_back(world.addShape(drawBush(rng, {0.3, 0.7}, {0.6, 1.4})));
    }
    for (int i = 0; i < 2; ++i)
    {
      trees.push_back(world.addShape(drawTree(rng, {4.5, 8}, {1.2, 2.2}, {2.3, 3})));
    }
    clutter = {world.addShape(makeBin()), world.addShape(makeCabinet()),
               world.addShape(makeBollard())};
    bollard = clutter[2];
    const float arm = in(0.6, 1.6);
    lamp = world.addShape(makeLampPost(in(5, 8.5), arm));
    light = world.addShape(makeTrafficLight());
    pole = world.addShape(makeLampPost(in(6.5, 8), 0.25F));
    barrier = world.addShape(makeFence(1, 3.0F, 1.0F));
  }
};

/** Vehicles of narrow streets, in addition to those of all worlds: small trucks and vans. */
void addSmallTrucks(World& world, Rng& rng)
{
  for (int i = 0; i < 3; ++i)
  {
    const float length = static_cast<float>(rng.uniform(4.8, 6.4)),
                width = static_cast<float>(rng.uniform(1.75, 2.1)),
                height = static_cast<float>(rng.uniform(2.3, 3.0));
    world.trucks.push_back(addRigid(world, makeTruck(length, width, height, false),
                                    ObjectClass::truck, 0.55 * static_cast<double>(length)));
  }
}

class DowntownBuilder
{
 public:
  /** \param ring_low, ring_high corners of the ego's loop, local coordinates [m] */
  DowntownBuilder(
      World& world, const StreetGrid& grid, const P& ring_low, const P& ring_high, Rng& rng)
      : world_(world),
        grid_(grid),
        ring_low_(ring_low),
        ring_high_(ring_high),
        rng_(rng),
        shapes_(world, rng)
  {
    addSmallTrucks(world, rng);
    for (const int truck : world.trucks)
    {
      if (world.bodies[static_cast<std::size_t>(truck)].size.y() < 2.2)
      {
        parked_trucks_.push_back(truck);
      }
    }
  }

  /** Houses around block (i, j). */
  void block(int i, int j)
  {
    const auto e = grid_.blockInside(i, j);
    const P sw(e[0], e[1]), se(e[2], e[1]), ne(e[2], e[3]), nw(e[0], e[3]);
    const double width = e[2] - e[0], height = e[3] - e[1], depth = 17;
    const int nu = static_cast<int>(grid_.along_v.size()),
              nv = static_cast<int>(grid_.along_u.size());
    // The south and north sides include the corners.
    const bool south = j >= 0, north = j + 1 < nv, west = i >= 0, east = i + 1 < nu;
    if (south)
    {
      side({se, P(-1, 0), P(0, 1), width, depth});
    }
    if (north)
    {
      side({nw, P(1, 0), P(0, -1), width, depth});
    }
    const double cut0 = south ? depth + 1 : 0, cut1 = north ? depth + 1 : 0;
    if (west && height - cut0 - cut1 > 8)
    {
      side({sw + P(0, cut0), P(0, 1), P(1, 0), height - cut0 - cut1, depth});
    }
    if (east && height - cut0 - cut1 > 8)
    {
      side({ne - P(0, cut1), P(0, -1), P(-1, 0), height - cut0 - cut1, depth});
    }
  }

  /** Parked vehicles and the furniture of the pavements. */
  void street(const Street& street, bool runs_along_v, double from, double to)
  {
    for (const double side : {-1.0, 1.0})
    {
      const Kerb kerb{street, runs_along_v, side};
      parkVehicles(kerb, from, to);
      furnishPavement(kerb, from, to);
    }
  }

  void junction(const Street& a, const Street& b, bool lights)
  {
    for (const double su : {-1.0, 1.0})
    {
      for (const double sv : {-1.0, 1.0})
      {
        const P where(a.centre + su * (a.half() + 0.6), b.centre + sv * (b.half() + 2.0));
        const int shape = lights ? shapes_.light : rng_.pick(shapes_.signs);
        world_.placeOnGround(shape, grid_.toWorld(where), rng_.uniform(0, 6.28));
      }
    }
  }

 private:
  /** One side of a street. */
  struct Kerb
  {
    const Street& street;
    bool along_v;
    double side;  // -1 or 1
    /** \param s along the street \param d from the centre line to this side [m] */
    [[nodiscard]] P at(double s, double d) const
    {
      return along_v ? P(street.centre + side * d, s) : P(s, street.centre - side * d);
    }
  };

  /** Whether the ego can see the place from close by. */
  bool near(const P& local) const
  {
    constexpr double kReach = 75;  // [m]
    const P nearest = local.cwiseMax(ring_low_).cwiseMin(ring_high_);
    const double outside = (local - nearest).norm();
    const double inside = std::min((local - ring_low_).minCoeff(), (ring_high_ - local).minCoeff());
    return outside < kReach && inside < kReach;
  }

  bool clear(const Kerb& kerb, double s, double margin) const
  {
    const auto& crossing = kerb.along_v ? grid_.along_u : grid_.along_v;
    return std::all_of(crossing.begin(), crossing.end(),
                       [&](const Street& c) { return std::abs(s - c.centre) > c.half() + margin; });
  }

  /** Heading of the street in the world, such that the kerb is on the right. */
  double heading(const Kerb& kerb, double s, double d) const
  {
    const P ahead = grid_.toWorld(kerb.at(s + 0.5 * kerb.side, d)) -
                    grid_.toWorld(kerb.at(s - 0.5 * kerb.side, d));
    return std::atan2(ahead.y(), ahead.x());
  }

  void placeAt(int shape, const Kerb& kerb, double s, double d, double turn = 0)
  {
    world_.placeOnGround(shape, grid_.toWorld(kerb.at(s, d)),
                         heading(kerb, s, d) + kHalfTurnAngle + turn);
  }

  void placeScooter(const P& local, double yaw)
  {
    const P w = grid_.toWorld(local);
    Eigen::Affine3f transform = Eigen::Affine3f::Identity();
    transform.translate(Eigen::Vector3d(w.x(), w.y(), grid_.heightLocal(local)).cast<float>());
    transform.rotate(Eigen::AngleAxisf(static_cast<float>(yaw), Eigen::Vector3f::UnitZ()));
    const auto lean = static_cast<float>(rng_.uniform(0.02, 0.16));
    transform.rotate(Eigen::AngleAxisf(lean, Eigen::Vector3f::UnitX()));
    transform.scale(static_cast<float>(rng_.uniform(0.92, 1.03)));
    const float paint = drawPaint(rng_);
    world_.place(rng_.pick(shapes_.scooters), transform, kMotorcycle, world_.nextInstance(), paint);
  }

  /** A row of scooters side by side. \param d distance of their middle from the centre line [m] */
  void scooterRow(const Kerb& kerb, double s, double length, double d)
  {
    const double sign = rng_.chance(0.5) ? 1 : -1;
    const double turn = sign * rng_.uniform(1.15, 1.57);
    const double end = s + length;
    while (s < end)
    {
      if (near(kerb.at(s, d)))
      {
        const double yaw = heading(kerb, s, d) + turn + rng_.uniform(-0.12, 0.12);
        placeScooter(kerb.at(s, d + rng_.uniform(-0.06, 0.06)), yaw);
      }
      s += rng_.chance(0.1) ? rng_.uniform(1.2, 2.5) : rng_.uniform(0.55, 0.8);
    }
  }

  void parkVehicles(const Kerb& kerb, double from, double to)
  {
    const Street& street = kerb.street;
    if (street.parking <= 0)
    {
      return;
    }
    for (double s = from + rng_.uniform(0, 6); s < to;)
    {
      if (!clear(kerb, s, 7.0))
      {
        s += 1;
        continue;
      }
      const double kind = rng_.uniform();
      double length = 3;  // of an empty part
      if (kind < 0.55 * street.occupancy)
      {
        length = rng_.uniform(3, 14);
        while (length > 1 && !clear(kerb, s + length, 7.0))
        {
          length -= 1;
        }
        scooterRow(kerb, s, length, street.carriageway() + 0.5 * street.parking + 0.05);
        length += 1.2;
      }
      else if (kind < street.occupancy)
      {
        length = parkVehicle(kerb, s);
      }
      s += length + rng_.uniform(0.6, 1.6);
    }
  }

  /** A car, van or truck whose rear is at s. \return its length [m] */
  double parkVehicle(const Kerb& kerb, double s)
  {
    const double u = rng_.uniform();
    const int model = u < 0.55  ? rng_.pick(world_.cars)
                      : u < 0.8 ? rng_.pick(world_.vans)
                                : rng_.pick(parked_trucks_);
    const BodyModel& body = world_.bodies[static_cast<std::size_t>(model)];
    const double length = body.size.x(), middle = s + 0.5 * length;
    const double d = kerb.street.carriageway() + 0.1 + 0.5 * body.size.y();
    const bool ahead = rng_.chance(0.85);
    const double yaw =
        heading(kerb, middle, d) + (ahead ? 0 : kHalfTurnAngle) + rng_.uniform(-0.02, 0.02);
    if (clear(kerb, s + length, 5.0) && near(kerb.at(middle, d)))
    {
      world_.park(model, grid_.toWorld(kerb.at(middle, d)), yaw, rng_);
    }
    return length;
  }

  /** Thin things at the kerb, stalls where there is room, goods at the houses; people walk between
   * them. */
  void furnishPavement(const Kerb& kerb, double from, double to)
  {
    const Street& street = kerb.street;
    const double at_kerb = street.half() + 0.4, at_wall = street.half() + street.walk - 0.4;
    const bool wide = street.walk >= 3.9;
    const bool barrier = rng_.chance(0.2);
    double next_pole = from + rng_.uniform(3, 20), next_tree = from + rng_.uniform(2, 12);
    double free_from = from;
    Eigen::Vector3f last_pole = Eigen::Vector3f::Zero();
    bool has_pole = false;
    for (double s = from; s < to; s += 1.0)
    {
      if (!clear(kerb, s, 3.5) || !near(kerb.at(s, at_kerb)))
      {
        has_pole = false;
        continue;
      }
      if (s >= next_pole)
      {
        next_pole = s + rng_.uniform(15, 28);
        placeAt(rng_.chance(0.3) ? shapes_.lamp : shapes_.pole, kerb, s, at_kerb, kHalfTurnAngle);
        const Eigen::Vector3f top = grid_.point(kerb.at(s, at_kerb), 6.2);
        if (has_pole)
        {
          addCables(last_pole, top);
        }
        last_pole = top;
        has_pole = true;
        continue;
      }
      if (s >= free_from)
      {
        free_from = s + furnishKerb(kerb, s, at_kerb, wide, barrier);
      }
      if (street.trees && s >= next_tree && wide)
      {
        next_tree = s + rng_.uniform(7, 16);
        const int tree = rng_.pick(shapes_.trees);
        placeAt(tree, kerb, s, at_kerb + 0.2, rng_.uniform(0, 6.28));
      }
      furnishWall(kerb, s, at_wall);
    }
  }

  /** \return length that is taken along the kerb [m] */
  double furnishKerb(const Kerb& kerb, double s, double at_kerb, bool wide, bool barrier)
  {
    const double u = rng_.uniform();
    if (barrier && u < 0.9)
    {
      placeAt(shapes_.barrier, kerb, s, at_kerb - 0.2);
      return 3;
    }
    if (wide && u < 0.10)
    {
      placeAt(rng_.pick(shapes_.stalls), kerb, s + 1.5, at_kerb + 0.2);
      return 3.5;
    }
    if (wide && u < 0.13)
    {
      placeAt(rng_.pick(shapes_.umbrellas), kerb, s + 1, at_kerb + 0.1);
      return 3;
    }
    if (u < 0.20)
    {
      placeAt(rng_.pick(shapes_.signs), kerb, s, at_kerb);
      return 1;
    }
    if (u < 0.27)
    {
      placeAt(rng_.pick(shapes_.clutter), kerb, s, at_kerb);
      return 1.5;
    }
    if (u < 0.34)
    {
      for (int k = 0; k < 4; ++k)
      {
        placeAt(shapes_.bollard, kerb, s + 1.2 * k, at_kerb - 0.1);
      }
      return 5;
    }
    return 1;
  }

  void furnishWall(const Kerb& kerb, double s, double at_wall)
  {
    const double u = rng_.uniform();
    if (u < 0.10)
    {
      placeAt(rng_.pick(shapes_.goods), kerb, s, at_wall);
    }
    else if (u < 0.14)
    {
      placeAt(rng_.pick(shapes_.racks), kerb, s, at_wall + 0.1);
    }
    else if (u < 0.18)
    {
      const double yaw = heading(kerb, s, at_wall) + rng_.uniform(-0.2, 0.2);
      placeScooter(kerb.at(s, at_wall), yaw);
    }
    else if (u < 0.21)
    {
      const int bush = rng_.pick(shapes_.bushes);
      world_.placeOnGround(bush, grid_.toWorld(kerb.at(s, at_wall)), rng_.uniform(0, 6.28), 0.7F);
    }
    else if (u < 0.24)
    {
      placeAt(rng_.pick(shapes_.clutter), kerb, s, at_wall);
    }
  }

  /** Sagging cables between two poles. */
  void addCables(const Eigen::Vector3f& from, const Eigen::Vector3f& to)
  {
    const int cables = 1 + rng_.below(4);
    for (int k = 0; k < cables; ++k)
    {
      const Eigen::Vector3f low(0, 0, -0.35F * static_cast<float>(k));
      const Eigen::Vector3f sag(0, 0, static_cast<float>(-rng_.uniform(0.2, 0.7)));
      const Eigen::Vector3f middle = 0.5F * (from + to) + sag + low;
      addTube(world_.meshes.back(), from + low, middle, 0.015F, 0.015F, 4, Material::steel);
      addTube(world_.meshes.back(), middle, to + low, 0.015F, 0.015F, 4, Material::steel);
    }
  }

  // Houses

  Eigen::Affine3f frame(const Side& side, double s, double front, double width, double depth) const
  {
    return houseFrame(grid_, side, s, front, width, depth);
  }

  void side(const Side& side)
  {
    double s = 0;
    while (s < side.length - 3)
    {
      const double left = side.length - s;
      const double u = rng_.uniform();
      if (!near(side.at(s, 0)))
      {
        s += distantHouse(side, s, std::min(left, rng_.uniform(8, 16)));
      }
      else if (u < 0.13 && left > 8)
      {
        s += alley(side, s);
      }
      else if (u < 0.20 && left > 14)
      {
        s += courtyard(side, s);
      }
      else
      {
        s += house(side, s, left);
      }
    }
  }

  /** A house of which the ego sees little: walls only. */
  double distantHouse(const Side& side, double s, double width)
  {
    const double depth = side.depth - 2, front = rng_.chance(0.6) ? 0 : rng_.uniform(0, 2);
    const float top = static_cast<float>(rng_.uniform(4, 17));
    Mesh box;
    addBox(box,
           Eigen::Vector3f(static_cast<float>(0.5 * width), static_cast<float>(0.5 * depth),
                           0.5F * top - 0.75F),
           Eigen::Vector3f(static_cast<float>(width), static_cast<float>(depth), top + 1.5F),
           Material::plaster);
    world_.meshes.back().append(box, frame(side, s, front, width, depth));
    return width;
  }

  double house(const Side& side, double s, double left)
  {
    ShopHouseStyle style = drawShopHouse(rng_);
    double width = static_cast<double>(style.width);
    width = left - width < 3 ? left : width;
    style.width = static_cast<float>(width);
    const double u = rng_.uniform();
    // A little behind the line of its neighbours, or behind a yard
    const double front = u < 0.55 ? 0.05 : u < 0.82 ? rng_.uniform(0.2, 1.5) : rng_.uniform(2, 4);
    style.projection = front > 1.5 ? 0 : style.projection;
    style.depth =
        static_cast<float>(std::min(static_cast<double>(style.depth), side.depth - front));
    addShopHouse(world_.meshes.back(), style,
                 frame(side, s, front, width, static_cast<double>(style.depth)), rng_);
    if (front >= 2)
    {
      yard(side, s, width, front);
    }
    return width;
  }

  /** Between the pavement and a house that stands back: a fence with a gap, scooters, goods. */
  void yard(const Side& side, double s, double width, double front)
  {
    if (rng_.chance(0.5))
    {
      const int fence = rng_.pick(shapes_.fences);
      const double gap = rng_.uniform(0, width);
      for (double x = 0; x + 3 <= width; x += 3)
      {
        if (std::abs(x + 1.5 - gap) > 1.5)
        {
          fenceElement(side, s + x, 0.3, fence);
        }
      }
    }
    const int things = rng_.below(5);
    for (int k = 0; k < things; ++k)
    {
      const double x = rng_.uniform(0.5, width - 0.5), y = rng_.uniform(0.9, front - 0.5);
      yardThing(side.at(s + x, y));
    }
  }

  void fenceElement(const Side& side, double s, double inward, int fence)
  {
    const P a = grid_.toWorld(side.at(s, inward)), b = grid_.toWorld(side.at(s + 3, inward));
    world_.placeOnGround(fence, a, std::atan2(b.y() - a.y(), b.x() - a.x()));
  }

  void yardThing(const P& local)
  {
    const double u = rng_.uniform(), turned = rng_.uniform(0, 6.28);
    if (u < 0.45)
    {
      placeScooter(local, turned);
      return;
    }
    world_.placeOnGround(u < 0.6   ? rng_.pick(shapes_.goods)
                         : u < 0.7 ? rng_.pick(shapes_.umbrellas)
                         : u < 0.8 ? rng_.pick(shapes_.racks)
                         : u < 0.9 ? rng_.pick(shapes_.bushes)
                                   : rng_.pick(shapes_.clutter),
                         grid_.toWorld(local), turned);
  }

  double alley(const Side& side, double s)
  {
    const double width = rng_.uniform(2, 5), length = rng_.uniform(15, 40);
    addAlley(world_.meshes.back(), static_cast<float>(width), static_cast<float>(length),
             frame(side, s, 0.4, width, 4), rng_);
    const int things = rng_.below(6);
    for (int k = 0; k < things; ++k)
    {
      const double y = rng_.uniform(1.5, 0.8 * length);
      const double x = rng_.chance(0.5) ? 0.5 : width - 0.5;
      yardThing(side.at(s + x, y));
    }
    return width;
  }

  /** A yard behind a wall with an open gate; houses without shops around it. */
  double courtyard(const Side& side, double s)
  {
    const double width = rng_.uniform(9, 13), deep = rng_.uniform(8, 15);
    const double gate_width = rng_.uniform(2.5, 4.5), gate = rng_.uniform(0.5, width - 5);
    const float height = static_cast<float>(rng_.uniform(1.0, 2.8));
    addGateWall(world_.meshes.back(), static_cast<float>(width), height, static_cast<float>(gate),
                static_cast<float>(gate_width), frame(side, s, 0.2, width, 4));
    ShopHouseStyle style = drawShopHouse(rng_);
    style.width = static_cast<float>(width);
    style.depth = 8;
    style.open = 0.1F;
    style.signs = 0;
    style.projection = 0;
    addShopHouse(world_.meshes.back(), style, frame(side, s, deep, width, 8), rng_);
    const int things = 2 + rng_.below(8);
    for (int k = 0; k < things; ++k)
    {
      const double x = rng_.uniform(0.6, width - 0.6), y = rng_.uniform(1.5, deep - 3);
      yardThing(side.at(s + x, y));
    }
    if (rng_.chance(0.5))
    {
      const double x = rng_.uniform(2, width - 2);
      const P a = grid_.toWorld(side.at(s + x, 2)), b = grid_.toWorld(side.at(s + x, 7));
      world_.park(rng_.pick(world_.cars), 0.5 * (a + b), std::atan2(b.y() - a.y(), b.x() - a.x()),
                  rng_);
    }
    return width;
  }

  World& world_;
  const StreetGrid& grid_;
  P ring_low_, ring_high_;
  Rng& rng_;
  StreetShapes shapes_;
  std::vector<int> parked_trucks_;
};
}  // namespace

void buildDowntown(World& world, const SimulatorOptions& options)
{
  Rng rng(combine(world.seed, 0xD0373));
  const double block = rng.uniform(80, 110);
  const BlockRing ring = drawBlockRing(options.loop_length, block, rng);
  auto grid =
      std::make_unique<StreetGrid>(world.seed, ring.u + 2, ring.v + 2, block, drawDowntownStreet);
  grid->paved = true;
  const StreetGrid& streets = *grid;
  world.meshes.push_back(streets.mesh());
  world.ground = std::move(grid);
  world.meshes.emplace_back();  // all houses and cables
  const auto corner = [&](int i, int j)
  {
    return P(streets.along_v[static_cast<std::size_t>(i)].centre,
             streets.along_u[static_cast<std::size_t>(j)].centre);
  };
  DowntownBuilder builder(world, streets, corner(1, 1), corner(1 + ring.u, 1 + ring.v), rng);
  const int nu = static_cast<int>(streets.along_v.size()),
            nv = static_cast<int>(streets.along_u.size());
  for (int i = -1; i < nu; ++i)
  {
    for (int j = -1; j < nv; ++j)
    {
      builder.block(i, j);
    }
  }
  std::vector<double> light_cycles;  // by junction, in the order of the lane network's
  for (const auto& s : streets.along_v)
  {
    builder.street(s, true, streets.minV(), streets.maxV());
    for (const auto& t : streets.along_u)
    {
      light_cycles.push_back(rng.chance(0.5) ? rng.uniform(12, 22) : 0);
      builder.junction(s, t, light_cycles.back() > 0);
    }
  }
  for (const auto& s : streets.along_u)
  {
    builder.street(s, false, streets.minU(), streets.maxU());
  }
  setNetworks(streets, ring, rng.chance(0.5) != options.reverse, world);
  world.roads.light_cycles = light_cycles;
  for (Lane& lane : world.roads.lanes)
  {
    lane.speed_limit *= lane.junction < 0 ? 0.8 : 1.0;
  }
}
}  // namespace dyslam::sim
