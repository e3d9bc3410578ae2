// SPDX-License-Identifier: BSD-3-Clause
// Streets of a downtown world: parked vehicles, and what stands on the pavements.
#include <cmath>

#include "Downtown.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;

constexpr double kHalfTurnAngle = 3.14159265;  // [rad]

/** Builds the two kerbs of streets. */
class DowntownStreetBuilder
{
 public:
  explicit DowntownStreetBuilder(Downtown& town)
      : town_(town), world_(town.world), grid_(town.grid), rng_(town.rng), shapes_(town.shapes)
  {
  }

  /** Parked vehicles and the furniture of the pavements. \param from, to along the street [m] */
  void build(const Street& street, bool runs_along_v, double from, double to)
  {
    for (const double side : {-1.0, 1.0})
    {
      const Kerb kerb{street, runs_along_v, side};
      parkVehicles(kerb, from, to);
      furnishPavement(kerb, from, to);
    }
  }

 private:
  /** Heading of the street in the world, such that the kerb is on the right. */
  double heading(const Kerb& kerb, double s, double d) const
  {
    const P ahead = grid_.toWorld(kerb.at(s + 0.5 * kerb.side, d)) -
                    grid_.toWorld(kerb.at(s - 0.5 * kerb.side, d));
    return std::atan2(ahead.y(), ahead.x());
  }

  /** Places a shape with its y axis away from the carriageway, turned by `turn` [rad]. */
  void placeAt(int shape, const Kerb& kerb, double s, double d, double turn = 0)
  {
    world_.placeOnGround(shape, grid_.toWorld(kerb.at(s, d)),
                         heading(kerb, s, d) + kHalfTurnAngle + turn);
  }

  /** A row of scooters side by side. \param d distance of their middle from the centre line [m] */
  void scooterRow(const Kerb& kerb, double s, double length, double d)
  {
    const double sign = rng_.chance(0.5) ? 1 : -1;
    const double turn = sign * rng_.uniform(1.15, 1.57);
    const double end = s + length;
    while (s < end)
    {
      if (town_.near(kerb.at(s, d)))
      {
        const double yaw = heading(kerb, s, d) + turn + rng_.uniform(-0.12, 0.12);
        town_.placeScooter(kerb.at(s, d + rng_.uniform(-0.06, 0.06)), yaw);
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
      if (!kerb.isClear(grid_, s, 7.0))
      {
        s += 1;
        continue;
      }
      const double kind = rng_.uniform();
      double length = 3;  // of an empty part
      if (kind < 0.55 * street.occupancy)
      {
        length = rng_.uniform(3, 14);
        while (length > 1 && !kerb.isClear(grid_, s + length, 7.0))
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

  /** Parks a car, van or truck from s on, if there is room. \return its length [m] */
  double parkVehicle(const Kerb& kerb, double s)
  {
    const double u = rng_.uniform();
    const int model = u < 0.55  ? rng_.pick(world_.cars)
                      : u < 0.8 ? rng_.pick(world_.vans)
                                : rng_.pick(town_.parked_trucks);
    const BodyModel& body = world_.bodies[static_cast<std::size_t>(model)];
    const double length = body.size.x(), middle = s + 0.5 * length;
    const double d = kerb.street.carriageway() + 0.1 + 0.5 * body.size.y();
    const bool ahead = rng_.chance(0.85);
    const double yaw =
        heading(kerb, middle, d) + (ahead ? 0 : kHalfTurnAngle) + rng_.uniform(-0.02, 0.02);
    if (kerb.isClear(grid_, s + length, 5.0) && town_.near(kerb.at(middle, d)))
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
      if (!kerb.isClear(grid_, s, 3.5) || !town_.near(kerb.at(s, at_kerb)))
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

  /** Places something at the kerb, or nothing. \param at_kerb distance from the centre line [m]
   * \return length that is taken along the kerb [m] */
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

  /** Places something at the houses, or nothing. \param at_wall distance from the centre line [m]
   */
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
      town_.placeScooter(kerb.at(s, at_wall), yaw);
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

  Downtown& town_;
  World& world_;
  const StreetGrid& grid_;
  Rng& rng_;
  const DowntownShapes& shapes_;
};
}  // namespace

void addDowntownStreet(
    Downtown& town, const Street& street, bool runs_along_v, double from, double to)
{
  DowntownStreetBuilder(town).build(street, runs_along_v, from, to);
}

void addDowntownJunction(Downtown& town, const Street& a, const Street& b, bool lights)
{
  for (const double su : {-1.0, 1.0})
  {
    for (const double sv : {-1.0, 1.0})
    {
      const P where(a.centre + su * (a.half() + 0.6), b.centre + sv * (b.half() + 2.0));
      const int shape = lights ? town.shapes.light : town.rng.pick(town.shapes.signs);
      town.world.placeOnGround(shape, town.grid.toWorld(where), town.rng.uniform(0, 6.28));
    }
  }
}
}  // namespace dyslam::sim
