// SPDX-License-Identifier: BSD-3-Clause
// The dense centre of an old city: narrow streets with two lanes each way, open shops, alleys,
// courtyards, stalls, and rows of parked motorcycles.
#include <algorithm>
#include <cmath>

#include "Downtown.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

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

/** Adds small trucks to the vehicles of all worlds. */
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
}  // namespace

DowntownShapes::DowntownShapes(World& world, Rng& rng)
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

Downtown::Downtown(World& w, const StreetGrid& streets, const P& low, const P& high, Rng& draws)
    : world(w), grid(streets), rng(draws), shapes(w, draws), ring_low_(low), ring_high_(high)
{
  constexpr double kWidest = 2.2;  // of the vehicles in a parking strip [m]
  addSmallTrucks(world, rng);
  for (const int truck : world.trucks)
  {
    if (world.bodies[static_cast<std::size_t>(truck)].size.y() < kWidest)
    {
      parked_trucks.push_back(truck);
    }
  }
}

bool Downtown::near(const P& local) const
{
  constexpr double kReach = 75;  // [m]
  const P nearest = local.cwiseMax(ring_low_).cwiseMin(ring_high_);
  const double outside = (local - nearest).norm();
  const double inside = std::min((local - ring_low_).minCoeff(), (ring_high_ - local).minCoeff());
  return outside < kReach && inside < kReach;
}

void Downtown::placeScooter(const P& local, double yaw)
{
  constexpr std::uint16_t kMotorcycle = 15;  // SemanticKITTI class
  const P w = grid.toWorld(local);
  Eigen::Affine3f transform = Eigen::Affine3f::Identity();
  transform.translate(Eigen::Vector3d(w.x(), w.y(), grid.heightLocal(local)).cast<float>());
  transform.rotate(Eigen::AngleAxisf(static_cast<float>(yaw), Eigen::Vector3f::UnitZ()));
  const auto lean = static_cast<float>(rng.uniform(0.02, 0.16));
  transform.rotate(Eigen::AngleAxisf(lean, Eigen::Vector3f::UnitX()));
  transform.scale(static_cast<float>(rng.uniform(0.92, 1.03)));
  const float paint = drawPaint(rng);
  world.place(rng.pick(shapes.scooters), transform, kMotorcycle, world.nextInstance(), paint);
}

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
  Downtown town(world, streets, corner(1, 1), corner(1 + ring.u, 1 + ring.v), rng);
  const int nu = static_cast<int>(streets.along_v.size()),
            nv = static_cast<int>(streets.along_u.size());
  for (int i = -1; i < nu; ++i)
  {
    for (int j = -1; j < nv; ++j)
    {
      addDowntownBlock(town, i, j);
    }
  }
  std::vector<double> light_cycles;  // by junction, in the order of the lane network's
  for (const auto& s : streets.along_v)
  {
    addDowntownStreet(town, s, true, streets.minV(), streets.maxV());
    for (const auto& t : streets.along_u)
    {
      light_cycles.push_back(rng.chance(0.5) ? rng.uniform(12, 22) : 0);
      addDowntownJunction(town, s, t, light_cycles.back() > 0);
    }
  }
  for (const auto& s : streets.along_u)
  {
    addDowntownStreet(town, s, false, streets.minU(), streets.maxU());
  }
  setNetworks(streets, ring, rng.chance(0.5) != options.reverse, world);
  world.roads.light_cycles = light_cycles;
  for (Lane& lane : world.roads.lanes)
  {
    lane.speed_limit *= lane.junction < 0 ? 0.8 : 1.0;
  }
}
}  // namespace dyslam::sim
