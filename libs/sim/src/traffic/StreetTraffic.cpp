// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "StreetJunctions.h"
#include "StreetVehicles.h"
#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
constexpr double patience = 6;  // waiting time for road users beside the path [s]

/** How many vehicles there are, and of which kinds. */
struct Density
{
  double spacing;   // mean distance of vehicles on a lane in the densest traffic [m]
  double exponent;  // the spacing grows by this power of 1 / traffic
  double slowest;   // least speed that a driver wants, relative to the limit
  VehicleMix mix;
};

Density densityIn(WorldKind kind)
{
  switch (kind)
  {
    case WorldKind::urban:
      return {10, 1.6, 0.8, {0.06}};
    case WorldKind::downtown:
      return {16, 1.1, 0.6, {0.2, 0.16, 0.26}};
    case WorldKind::campus:
    case WorldKind::field:
      return {22, 1.6, 0.8, {0.02}};
    case WorldKind::highway:
    case WorldKind::tunnel:
    case WorldKind::indoor:
      break;
  }
  throw std::logic_error("StreetTraffic: highways and buildings have a traffic of their own");
}

class StreetTraffic : public Crowd::Group
{
 public:
  StreetTraffic(Crowd& crowd, bool with_ego)
      : crowd_(crowd),
        net_(crowd.world().roads),
        rng_(combine(crowd.options().trafficSeed(), 0x57AF)),
        vehicles_(net_),
        junctions_(net_, vehicles_)
  {
    if (with_ego)
    {
      startEgo();
    }
    populate();
  }

  void step(double dt) override
  {
    vehicles_.order();
    junctions_.grantTurns(crowd_.time());
    for (StreetVehicle& v : vehicles_.all())
    {
      if (isActive(v))
      {
        decide(v, dt);
      }
    }
    for (StreetVehicle& v : vehicles_.all())
    {
      const bool active = isActive(v);
      if (!v.isEgo())
      {
        crowd_.actor(v.actor).frozen = !active;
      }
      if (active)
      {
        move(v, dt);
      }
    }
  }

 private:
  const Lane& lane(int i) const { return vehicles_.lane(i); }

  bool isActive(const StreetVehicle& v) const
  {
    return v.isEgo() || crowd_.active(lane(v.lane).path.at(v.s).position);
  }

  void startEgo()
  {
    StreetVehicle ego;
    double s = crowd_.options().start_fraction * crowd_.world().loop_length;
    while (s > lane(net_.ego_route[ego.route_step]).path.length())
    {
      s -= lane(net_.ego_route[ego.route_step]).path.length();
      ego.route_step = (ego.route_step + 1) % net_.ego_route.size();
    }
    if (lane(net_.ego_route[ego.route_step]).junction >= 0)
    {
      ego.route_step = (ego.route_step + 1) % net_.ego_route.size();  // never starts on a junction
      s = 0;
    }
    ego.lane = net_.ego_route[ego.route_step];
    ego.s = std::max(s, 3.0);
    ego.v = 0.6 * egoCruise(crowd_.world(), crowd_.options());
    ego.next_stop = 8 + rng_.uniform(0, 40);
    add(ego);
  }

  void populate()
  {
    const double traffic = crowd_.options().traffic;
    const Density density = densityIn(crowd_.world().kind);
    const double spacing =
        traffic > 0 ? density.spacing / std::pow(traffic, density.exponent) : StreetVehicles::far;
    for (std::size_t l = 0; l < net_.lanes.size(); ++l)
    {
      const Lane& here = net_.lanes[l];
      if (here.junction >= 0)
      {
        continue;
      }
      double s = rng_.uniform(0.2, 1.0) * spacing;
      while (s < here.path.length() - 4)
      {
        StreetVehicle v;
        const int model = drawVehicle(crowd_.world(), rng_, density.mix);
        const BodyModel& body = crowd_.world().bodies[static_cast<std::size_t>(model)];
        v.length = body.size.x();
        v.width = body.size.y();
        v.lane = static_cast<int>(l);
        v.s = s;
        v.desired_speed = rng_.uniform(density.slowest, 1.15);
        v.headway = rng_.uniform(1.0, 1.8);
        v.v = std::min(0.5, 1 - traffic) * here.speed_limit;
        v.next_stop = rng_.uniform(5, 240);
        v.wander = rng_.uniform(0, 6.28);
        const bool room = v.length < 13 && s - 0.5 * v.length > 0.5 &&
                          s + 0.5 * v.length < here.path.length() && vehicles_.hasRoom(v);
        const float paint = drawPaint(rng_);
        const double step = v.length - 4.4 + spacing * rng_.uniform(0.7, 1.3);
        s += step;
        if (room)
        {
          v.actor = crowd_.addActor(model, paint);
          add(v);
        }
      }
    }
  }

  void add(const StreetVehicle& vehicle)
  {
    StreetVehicle& v = vehicles_.all().emplace_back(vehicle);
    chooseTurn(v);
    place(v);
  }

  void chooseTurn(StreetVehicle& v)
  {
    const auto& next = lane(v.lane).next;
    v.granted = false;
    v.waiting_since = -1;
    if (v.isEgo())
    {
      v.turn = net_.ego_route[(v.route_step + 1) % net_.ego_route.size()];
      return;
    }
    v.turn = next.empty() ? -1 : rng_.pick(next);
  }

  /** The nearest pedestrian or cyclist on the route. */
  StreetVehicles::Ahead roadUsersAhead(const StreetVehicle& v, const Path::Sample& here) const
  {
    const double reach = 0.5 * v.length + 5 + v.v * 2.2;
    StreetVehicles::Ahead nearest;
    const auto& actors = crowd_.actors();
    for (std::size_t i = 0; i < actors.size(); ++i)
    {
      const ObjectClass c = crowd_.model(static_cast<int>(i)).object_class;
      if (actors[i].frozen || (c != ObjectClass::pedestrian && c != ObjectClass::cyclist))
      {
        continue;
      }
      const Eigen::Vector2d p = actors[i].state.position.head<2>();
      if ((p - here.position).squaredNorm() > reach * reach)
      {
        continue;
      }
      const double margin = 0.5 * v.width + (c == ObjectClass::pedestrian ? 0.55 : 0.5);
      for (double s = 0.3 * v.length; s < reach; s += 1.0)
      {
        const Path::Sample q = vehicles_.along(v, s);
        if ((q.position - p).squaredNorm() < margin * margin)
        {
          const double gap = s - 0.5 * v.length - 0.5;
          if (gap < nearest.gap)
          {
            nearest.gap = gap;
            nearest.speed =
                actors[i].state.speed * std::max(0.0, std::cos(actors[i].state.yaw - q.heading));
          }
          break;
        }
      }
    }
    return nearest;
  }

  double wantedSpeed(const StreetVehicle& v) const
  {
    const double cruise =
        v.isEgo() ? egoCruise(crowd_.world(), crowd_.options()) : StreetVehicles::far;
    const Lane& here = lane(v.lane);
    double wanted = here.junction >= 0 ? std::min(here.speed_limit, cruise)
                                       : std::min(here.speed_limit * v.desired_speed, cruise);
    const int next = vehicles_.nextLane(v);
    if (next >= 0)
    {
      // Deceleration before a turn
      const double rest = std::max(0.0, here.path.length() - v.s);
      const double limit = lane(next).speed_limit;
      wanted = std::min(wanted, std::sqrt(limit * limit + 2 * 1.6 * rest));
    }
    return crowd_.time() < v.stop_until ? 0.05 : wanted;
  }

  void decide(StreetVehicle& v, double dt)
  {
    const Path::Sample here = lane(v.lane).path.at(v.s);
    if (crowd_.time() > v.next_stop)
    {
      // Vehicles do not stop on a junction; the ego stops only if the options allow it.
      const bool may = lane(v.lane).junction < 0 && (!v.isEgo() || crowd_.options().stops);
      v.stop_until = may ? crowd_.time() + rng_.uniform(2, 8) : v.stop_until;
      v.next_stop = crowd_.time() + (v.isEgo() ? 1 : 2) * rng_.uniform(40, 160);
    }
    const double wanted = wantedSpeed(v);
    const StreetVehicles::Ahead leader = vehicles_.leader(v);
    double a = driverAcceleration(v.v, wanted, leader.gap, leader.speed, v.headway);
    if (lane(v.lane).junction < 0 && v.turn >= 0 && lane(v.turn).junction >= 0 && !v.granted)
    {
      const double rest = lane(v.lane).path.length() - v.s - 0.5 * v.length + 2.0;
      a = std::min(a, driverAcceleration(v.v, wanted, rest, 0, 0.5));
    }
    const StreetVehicles::Ahead other = roadUsersAhead(v, here);
    if (other.gap < StreetVehicles::far && v.blocked_for < patience)
    {
      a = std::min(a, driverAcceleration(v.v, wanted, other.gap, other.speed, 0.6));
    }
    v.blocked_for =
        other.gap < 3 && v.v < 0.2 ? v.blocked_for + dt : std::max(0.0, v.blocked_for - 0.5 * dt);
    if (wanted < 0.1)
    {
      a = std::min(a, -1.8);
    }
    // Limited jerk, except in emergencies.
    const double blend = a < -4 ? 1.0 : std::min(1.0, dt / 0.25);
    v.a += blend * (a - v.a);
  }

  void move(StreetVehicle& v, double dt)
  {
    const double before = v.v;
    v.v = std::max(0.0, v.v + v.a * dt);
    if (v.v < 0.03 && v.a < 0.05)
    {
      v.v = 0;
    }
    v.s += 0.5 * (before + v.v) * dt;
    while (v.s > lane(v.lane).path.length())
    {
      const int next = vehicles_.nextLane(v);
      if (next < 0)
      {
        v.s = lane(v.lane).path.length();
        v.v = 0;
        break;
      }
      v.s -= lane(v.lane).path.length();
      v.previous_lane = v.lane;
      v.lane = next;
      if (v.isEgo())
      {
        v.route_step = (v.route_step + 1) % net_.ego_route.size();
      }
      if (lane(v.lane).junction < 0)
      {
        chooseTurn(v);
      }
    }
    place(v);
  }

  void place(const StreetVehicle& v)
  {
    const double half = v.isEgo() ? 1.35 : 0.5 * crowd_.model(v.actor).wheelbase;
    const Path::Sample front = vehicles_.along(v, half), back = vehicles_.along(v, -half);
    const Eigen::Vector2d d = front.position - back.position;
    const double yaw = d.norm() > 0.1 ? std::atan2(d.y(), d.x()) : front.heading;
    const double sway = 0.12 * std::sin(0.05 * v.s + v.wander);
    const Eigen::Vector2d position = 0.5 * (front.position + back.position) +
                                     sway * Eigen::Vector2d(-std::sin(yaw), std::cos(yaw));
    if (v.isEgo())
    {
      crowd_.ego() = {position, yaw, v.v};
      return;
    }
    crowd_.setPosition(v.actor, position, yaw);
    crowd_.actor(v.actor).state.speed = v.v;
  }

  Crowd& crowd_;
  const LaneNetwork& net_;
  Rng rng_;
  StreetVehicles vehicles_;
  StreetJunctions junctions_;
};
}  // namespace

std::unique_ptr<Crowd::Group> makeStreetTraffic(Crowd& crowd, bool with_ego)
{
  return std::make_unique<StreetTraffic>(crowd, with_ego);
}
}  // namespace dyslam::sim
