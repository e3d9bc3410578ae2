// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
constexpr double kFar = 1e9;
constexpr double kPatience = 6;  // waiting time for road users beside the path [s]

struct Vehicle
{
  int actor = -1;  // -1: the ego
  double length = 4.5, width = 1.8;
  int lane = 0, previous_lane = -1;
  double s = 0, v = 0, a = 0;
  double desired_speed = 1;  // speed relative to the limit
  double headway = 1.3;      // [s]
  int turn = -1;             // chosen turn at the next junction
  bool granted = false;
  double waiting_since = -1;
  double stop_until = 0, next_stop = 0;
  double blocked_for = 0;
  std::size_t route_step = 0;  // position of the ego in LaneNetwork::ego_route
  double wander = 0;           // phase of the lateral oscillation in the lane
};

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
      break;
  }
  throw std::logic_error("StreetTraffic: highways have a traffic of their own");
}

class StreetTraffic : public Crowd::Group
{
 public:
  StreetTraffic(Crowd& crowd, bool with_ego)
      : crowd_(crowd),
        net_(crowd.world().roads),
        rng_(combine(crowd.options().trafficSeed(), 0x57AF)),
        with_ego_(with_ego)
  {
    if (with_ego_)
    {
      startEgo();
    }
    populate();
    order();
  }

  void step(double dt) override
  {
    order();
    grantJunctions();
    for (auto& v : vehicles_)
    {
      if (isActive(v))
      {
        decide(v, dt);
      }
    }
    for (auto& v : vehicles_)
    {
      const bool active = isActive(v);
      if (v.actor >= 0)
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
  const Lane& lane(int i) const { return net_.lanes[static_cast<std::size_t>(i)]; }

  bool isActive(const Vehicle& v) const
  {
    return v.actor < 0 || crowd_.active(lane(v.lane).path.at(v.s).position);
  }

  void startEgo()
  {
    Vehicle ego;
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
    vehicles_.push_back(ego);
    chooseTurn(vehicles_.back());
    place(vehicles_.back());
  }

  void populate()
  {
    const double traffic = crowd_.options().traffic;
    const Density density = densityIn(crowd_.world().kind);
    const double spacing =
        traffic > 0 ? density.spacing / std::pow(traffic, density.exponent) : kFar;
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
        Vehicle v;
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
                          s + 0.5 * v.length < here.path.length() && roomFor(v);
        const float paint = drawPaint(rng_);
        const double step = v.length - 4.4 + spacing * rng_.uniform(0.7, 1.3);
        s += step;
        if (room)
        {
          v.actor = crowd_.addActor(model, paint);
          chooseTurn(v);
          vehicles_.push_back(v);
          place(vehicles_.back());
        }
      }
    }
  }

  bool roomFor(const Vehicle& v) const
  {
    return std::all_of(
        vehicles_.begin(), vehicles_.end(),
        [&](const Vehicle& o)
        { return o.lane != v.lane || std::abs(o.s - v.s) > 0.5 * (o.length + v.length) + 2; });
  }

  void chooseTurn(Vehicle& v)
  {
    const auto& next = lane(v.lane).next;
    v.granted = false;
    v.waiting_since = -1;
    if (v.actor < 0)
    {
      v.turn = net_.ego_route[(v.route_step + 1) % net_.ego_route.size()];
      return;
    }
    v.turn = next.empty() ? -1 : rng_.pick(next);
  }

  /** Sorts the vehicles of each lane by arc length and collects the users of the junctions. */
  void order()
  {
    on_lane_.assign(net_.lanes.size(), {});
    users_.assign(static_cast<std::size_t>(net_.junctions), {});
    for (std::size_t i = 0; i < vehicles_.size(); ++i)
    {
      const Vehicle& v = vehicles_[i];
      on_lane_[static_cast<std::size_t>(v.lane)].push_back(static_cast<int>(i));
      // A turn is reserved from its grant until the rear of the vehicle has left it.
      const int turn = lane(v.lane).junction >= 0 ? v.lane
                       : v.granted                ? v.turn
                       : v.previous_lane >= 0 && lane(v.previous_lane).junction >= 0 &&
                               v.s < 0.5 * v.length + 1.0
                           ? v.previous_lane
                           : -1;
      if (turn >= 0 && lane(turn).junction >= 0)
      {
        users_[static_cast<std::size_t>(lane(turn).junction)].push_back(
            {static_cast<int>(i), turn});
      }
    }
    for (auto& list : on_lane_)
    {
      std::sort(list.begin(), list.end(),
                [&](int a, int b) {
                  return vehicles_[static_cast<std::size_t>(a)].s <
                         vehicles_[static_cast<std::size_t>(b)].s;
                });
    }
  }

  void grantJunctions()
  {
    std::vector<int> waiting;
    for (std::size_t i = 0; i < vehicles_.size(); ++i)
    {
      Vehicle& v = vehicles_[i];
      if (lane(v.lane).junction >= 0 || v.turn < 0 || v.granted || lane(v.turn).junction < 0)
      {
        continue;
      }
      const double rest = lane(v.lane).path.length() - v.s - 0.5 * v.length;
      const bool first = on_lane_[static_cast<std::size_t>(v.lane)].back() == static_cast<int>(i);
      if (first && rest < v.v * v.v / 4.0 + 8 && !isRed(lane(v.turn)))
      {
        v.waiting_since = v.waiting_since < 0 ? crowd_.time() : v.waiting_since;
        waiting.push_back(static_cast<int>(i));
      }
    }
    std::sort(waiting.begin(), waiting.end(),
              [&](int a, int b)
              {
                const double ta = vehicles_[static_cast<std::size_t>(a)].waiting_since,
                             tb = vehicles_[static_cast<std::size_t>(b)].waiting_since;
                return ta != tb ? ta < tb : a < b;
              });
    for (const int i : waiting)
    {
      Vehicle& v = vehicles_[static_cast<std::size_t>(i)];
      auto& users = users_[static_cast<std::size_t>(lane(v.turn).junction)];
      const auto& conflicts = lane(v.turn).conflicts;
      const bool clash = std::any_of(
          users.begin(), users.end(),
          [&](const User& u)
          { return std::find(conflicts.begin(), conflicts.end(), u.turn) != conflicts.end(); });
      if (!clash && exitIsFree(v, users))
      {
        v.granted = true;
        users.push_back({i, v.turn});
      }
      else if (crowd_.time() - v.waiting_since > 5)
      {
        users.push_back({i, v.turn});  // this vehicle has priority over later ones
      }
    }
  }

  /** Whether the traffic light is red for a turn: the two streets have green alternately. */
  bool isRed(const Lane& turn) const
  {
    const auto junction = static_cast<std::size_t>(turn.junction);
    if (net_.light_cycles.empty() || net_.light_cycles[junction] <= 0)
    {
      return false;
    }
    const double begin = 0.37 * turn.junction + 0.5 * turn.axis;  // of green [cycles]
    const double phase = crowd_.time() / net_.light_cycles[junction] - begin;
    return phase - std::floor(phase) > 0.42;
  }

  struct User
  {
    int vehicle;
    int turn;
  };

  bool exitIsFree(const Vehicle& v, const std::vector<User>& users) const
  {
    const int exit = lane(v.turn).next.front();
    double needed = v.length + 3;
    for (const auto& u : users)
    {
      if (lane(u.turn).next.front() == exit)
      {
        needed += vehicles_[static_cast<std::size_t>(u.vehicle)].length + 3;
      }
    }
    const auto& list = on_lane_[static_cast<std::size_t>(exit)];
    if (list.empty())
    {
      return true;
    }
    const Vehicle& last = vehicles_[static_cast<std::size_t>(list.front())];
    return last.s - 0.5 * last.length > needed || last.v > 4;
  }

  /** Gap to and speed of the leader along the chosen route. */
  std::pair<double, double> leader(const Vehicle& v) const
  {
    const auto& mine = on_lane_[static_cast<std::size_t>(v.lane)];
    for (const int i : mine)
    {
      const Vehicle& o = vehicles_[static_cast<std::size_t>(i)];
      if (o.s > v.s && &o != &v)
      {
        return {o.s - v.s - 0.5 * (o.length + v.length), o.v};
      }
    }
    double ahead = lane(v.lane).path.length() - v.s;
    int next = nextLane(v);
    for (int hop = 0; hop < 3 && next >= 0 && ahead < 70; ++hop)
    {
      const auto& list = on_lane_[static_cast<std::size_t>(next)];
      if (!list.empty())
      {
        const Vehicle& o = vehicles_[static_cast<std::size_t>(list.front())];
        return {ahead + o.s - 0.5 * (o.length + v.length), o.v};
      }
      ahead += lane(next).path.length();
      next = lane(next).junction >= 0 ? lane(next).next.front() : -1;
    }
    return {kFar, 0};
  }

  int nextLane(const Vehicle& v) const
  {
    return lane(v.lane).junction >= 0 ? lane(v.lane).next.front() : v.turn;
  }

  /** Gap to and speed of pedestrians and cyclists on the route. */
  std::pair<double, double> roadUsersAhead(const Vehicle& v, const Path::Sample& here) const
  {
    const double reach = 0.5 * v.length + 5 + v.v * 2.2;
    double best = kFar, speed = 0;
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
        const Path::Sample q = along(v, s);
        if ((q.position - p).squaredNorm() < margin * margin)
        {
          const double gap = s - 0.5 * v.length - 0.5;
          if (gap < best)
          {
            best = gap;
            speed =
                actors[i].state.speed * std::max(0.0, std::cos(actors[i].state.yaw - q.heading));
          }
          break;
        }
      }
    }
    return {best, speed};
  }

  Path::Sample along(const Vehicle& v, double offset) const
  {
    double s = v.s + offset;
    int l = v.lane;
    if (s < 0 && v.previous_lane >= 0)
    {
      return lane(v.previous_lane).path.at(lane(v.previous_lane).path.length() + s);
    }
    for (int hop = 0; hop < 3; ++hop)
    {
      const double length = lane(l).path.length();
      const int next = hop == 0 ? nextLane(v) : lane(l).junction >= 0 ? lane(l).next.front() : -1;
      if (s <= length || next < 0)
      {
        break;
      }
      s -= length;
      l = next;
    }
    return lane(l).path.at(s);
  }

  double wantedSpeed(const Vehicle& v) const
  {
    const double cruise = v.actor < 0 ? egoCruise(crowd_.world(), crowd_.options()) : kFar;
    const Lane& here = lane(v.lane);
    double wanted = here.junction >= 0 ? std::min(here.speed_limit, cruise)
                                       : std::min(here.speed_limit * v.desired_speed, cruise);
    const int next = nextLane(v);
    if (next >= 0)
    {
      // Deceleration before a turn
      const double rest = std::max(0.0, here.path.length() - v.s);
      const double limit = lane(next).speed_limit;
      wanted = std::min(wanted, std::sqrt(limit * limit + 2 * 1.6 * rest));
    }
    return crowd_.time() < v.stop_until ? 0.05 : wanted;
  }

  void decide(Vehicle& v, double dt)
  {
    const Path::Sample here = lane(v.lane).path.at(v.s);
    if (crowd_.time() > v.next_stop)
    {
      // Vehicles do not stop on a junction; the ego stops only if the options allow it.
      const bool may = lane(v.lane).junction < 0 && (v.actor >= 0 || crowd_.options().stops);
      v.stop_until = may ? crowd_.time() + rng_.uniform(2, 8) : v.stop_until;
      v.next_stop = crowd_.time() + (v.actor < 0 ? 1 : 2) * rng_.uniform(40, 160);
    }
    const double wanted = wantedSpeed(v);
    auto [gap, leader_speed] = leader(v);
    double a = driverAcceleration(v.v, wanted, gap, leader_speed, v.headway);
    if (lane(v.lane).junction < 0 && v.turn >= 0 && lane(v.turn).junction >= 0 && !v.granted)
    {
      const double rest = lane(v.lane).path.length() - v.s - 0.5 * v.length + 2.0;
      a = std::min(a, driverAcceleration(v.v, wanted, rest, 0, 0.5));
    }
    const auto [other_gap, other_speed] = roadUsersAhead(v, here);
    if (other_gap < kFar && v.blocked_for < kPatience)
    {
      a = std::min(a, driverAcceleration(v.v, wanted, other_gap, other_speed, 0.6));
    }
    v.blocked_for =
        other_gap < 3 && v.v < 0.2 ? v.blocked_for + dt : std::max(0.0, v.blocked_for - 0.5 * dt);
    if (wanted < 0.1)
    {
      a = std::min(a, -1.8);
    }
    // Limited jerk, except in emergencies.
    const double blend = a < -4 ? 1.0 : std::min(1.0, dt / 0.25);
    v.a += blend * (a - v.a);
  }

  void move(Vehicle& v, double dt)
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
      const int next = nextLane(v);
      if (next < 0)
      {
        v.s = lane(v.lane).path.length();
        v.v = 0;
        break;
      }
      v.s -= lane(v.lane).path.length();
      v.previous_lane = v.lane;
      v.lane = next;
      if (v.actor < 0)
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

  void place(const Vehicle& v)
  {
    const double half = v.actor < 0 ? 1.35 : 0.5 * crowd_.model(v.actor).wheelbase;
    const Path::Sample front = along(v, half), back = along(v, -half);
    const Eigen::Vector2d d = front.position - back.position;
    const double yaw = d.norm() > 0.1 ? std::atan2(d.y(), d.x()) : front.heading;
    const double sway = 0.12 * std::sin(0.05 * v.s + v.wander);
    const Eigen::Vector2d position = 0.5 * (front.position + back.position) +
                                     sway * Eigen::Vector2d(-std::sin(yaw), std::cos(yaw));
    if (v.actor < 0)
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
  bool with_ego_;
  std::vector<Vehicle> vehicles_;
  std::vector<std::vector<int>> on_lane_;
  std::vector<std::vector<User>> users_;
};
}  // namespace

std::unique_ptr<Crowd::Group> makeStreetTraffic(Crowd& crowd, bool with_ego)
{
  return std::make_unique<StreetTraffic>(crowd, with_ego);
}
}  // namespace dyslam::sim
