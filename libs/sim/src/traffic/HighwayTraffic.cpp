// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
/** Length of the window around the ego that is filled with traffic [m]. Vehicles that leave it
 * re-enter at the other end, out of range. */
constexpr double kWindow = 560;

struct Car
{
  int actor = -1;  // -1: the ego
  double length = 4.5, wheelbase = 2.7;
  int direction = 1;  // +1 with the ego, -1 oncoming
  int lane = 0;       // 0 is the innermost
  double s = 0;       // arc length along the centre line, in the driving direction
  double v = 0, a = 0;
  double desired_speed = 28, headway = 1.2;
  double change = 0;    // offset of the old lane from the new one, left positive [m]
  double progress = 1;  // progress of the lane change, from 0 to 1
  double last_change = -100;
  double wander = 0;
};

/** Smooth step from 0 to 1 without speed or acceleration at both ends. */
double eased(double p)
{
  return p * p * p * (10 + p * (6 * p - 15));
}

double easedSlope(double p)
{
  return 30 * p * p * (1 - p) * (1 - p);
}

class HighwayTraffic : public Crowd::Group
{
 public:
  explicit HighwayTraffic(Crowd& crowd)
      : crowd_(crowd),
        world_(crowd.world()),
        window_(std::min(kWindow, 0.9 * world_.highway.length())),
        rng_(combine(crowd.options().trafficSeed(), 0x419)),
        lanes_(world_.highway_lanes)
  {
    Car ego;
    ego.lane = lanes_ > 1 ? 1 : 0;
    ego.length = 4.6;
    ego.s = crowd.options().start_fraction * world_.highway.length();
    ego.desired_speed = egoCruise(world_, crowd.options());
    ego.v = ego.desired_speed * speedFactor();
    cars_.push_back(ego);
    for (const int direction : {1, -1})
    {
      for (int lane = 0; lane < lanes_; ++lane)
      {
        fillLane(direction, lane);
      }
    }
    for (const auto& c : cars_)
    {
      place(c);
    }
  }

  void step(double dt) override
  {
    order();
    for (auto& c : cars_)
    {
      decide(c, dt);
    }
    for (auto& c : cars_)
    {
      move(c, dt);
    }
  }

 private:
  /** Factor by which dense traffic is slower. */
  double speedFactor() const
  {
    const double t = crowd_.options().traffic;
    return t < 0.5 ? 1.0 : 1.0 - 1.7 * (t - 0.5);
  }

  void fillLane(int direction, int lane)
  {
    const double traffic = crowd_.options().traffic;
    if (traffic <= 0)
    {
      return;
    }
    const double spacing = std::max(9.0, 10.5 / std::pow(traffic, 1.7));
    const double ego = cars_.front().s;
    double s = ego - 0.5 * window_ + rng_.uniform(0, 0.5) * spacing;
    while (s < ego + 0.5 * window_ - 6)
    {
      Car c;
      const int model = drawVehicle(world_, rng_,
                                    {lane == lanes_ - 1 ? 0.4
                                     : lane == 0        ? 0.02
                                                        : 0.12});
      const BodyModel& m = world_.bodies[static_cast<std::size_t>(model)];
      c.length = m.size.x();
      c.wheelbase = m.wheelbase;
      c.direction = direction;
      c.lane = lane;
      s += 0.5 * c.length;
      c.s = s;
      const bool heavy = m.object_class == ObjectClass::truck || m.object_class == ObjectClass::bus;
      c.desired_speed = (world_.kind == WorldKind::tunnel ? 0.72 : 1.0) *
                        (heavy ? rng_.uniform(21, 24) : rng_.uniform(25, 35) - 2.0 * lane);
      c.headway = rng_.uniform(0.8, 1.6);
      c.v = c.desired_speed * speedFactor() * 0.9;
      c.wander = rng_.uniform(0, 6.28);
      const float paint = drawPaint(rng_);
      const double next =
          s + 0.5 * c.length + std::max(2.5, (spacing - 5) * rng_.uniform(0.4, 1.6));
      const Car& me = cars_.front();
      const bool clear = direction != me.direction || lane != me.lane ||
                         std::abs(s - me.s) > 0.5 * (c.length + me.length) + 5;
      if (clear && s + 0.5 * c.length + 3 < ego + 0.5 * window_)
      {
        c.actor = crowd_.addActor(model, paint);
        cars_.push_back(c);
      }
      s = next;
    }
  }

  void order()
  {
    lane_lists_.assign(static_cast<std::size_t>(2 * lanes_), {});
    for (std::size_t i = 0; i < cars_.size(); ++i)
    {
      lane_lists_[listOf(cars_[i].direction, cars_[i].lane)].push_back(static_cast<int>(i));
    }
    for (auto& list : lane_lists_)
    {
      std::sort(
          list.begin(), list.end(),
          [&](int a, int b)
          { return cars_[static_cast<std::size_t>(a)].s < cars_[static_cast<std::size_t>(b)].s; });
    }
  }

  std::size_t listOf(int direction, int lane) const
  {
    return static_cast<std::size_t>((direction > 0 ? 0 : lanes_) + lane);
  }

  struct Neighbours
  {
    const Car* ahead = nullptr;
    const Car* behind = nullptr;
    double gap_ahead = 1e9, gap_behind = 1e9;
  };

  /** Leader and follower in a lane; the window is periodic. */
  Neighbours neighboursOf(const Car& me, int lane) const
  {
    Neighbours n;
    for (const int i : lane_lists_[listOf(me.direction, lane)])
    {
      const Car& o = cars_[static_cast<std::size_t>(i)];
      if (&o == &me)
      {
        continue;
      }
      const double room = 0.5 * (o.length + me.length);
      double d = std::fmod(o.s - me.s, window_);
      d = d < 0 ? d + window_ : d;
      if (d - room < n.gap_ahead)
      {
        n.gap_ahead = d - room;
        n.ahead = &o;
      }
      if (window_ - d - room < n.gap_behind)
      {
        n.gap_behind = window_ - d - room;
        n.behind = &o;
      }
    }
    return n;
  }

  double acceleration(const Car& c, const Neighbours& n) const
  {
    return driverAcceleration(
        c.v, c.desired_speed * (crowd_.time() < slow_until_ && c.direction > 0 ? 0.35 : 1.0),
        n.ahead != nullptr ? n.gap_ahead : 1e9, n.ahead != nullptr ? n.ahead->v : 0, c.headway);
  }

  void decide(Car& c, double dt)
  {
    if (&c == &cars_.front() && crowd_.options().traffic > 0.6 && crowd_.time() > next_slow_)
    {
      // Occasional braking waves
      slow_until_ = crowd_.time() + rng_.uniform(3, 8);
      next_slow_ = slow_until_ + rng_.uniform(15, 40);
    }
    const Neighbours here = neighboursOf(c, c.lane);
    double a = acceleration(c, here);
    const bool may_change =
        c.progress >= 1 && crowd_.time() - c.last_change > 4 && c.v > 4 && c.length < 13;
    if (may_change)
    {
      for (const int to : {c.lane - 1, c.lane + 1})
      {
        if (to < 0 || to >= lanes_)
        {
          continue;
        }
        const Neighbours there = neighboursOf(c, to);
        const double gain = acceleration(c, there) - a + (to > c.lane ? 0.1 : 0.0);  // keep right
        const double closing = there.behind != nullptr ? std::max(0.0, there.behind->v - c.v) : 0.0;
        const bool safe =
            there.gap_ahead > 4 + 0.4 * c.v && there.gap_behind > 5 + 0.3 * c.v + 2.5 * closing;
        if (safe && gain > 0.35 && rng_.chance(0.4 * dt * 20))
        {
          // The left of the driving direction is towards the centre line.
          c.change = (to > c.lane ? 1 : -1) * world_.highway_lane_width;
          c.progress = 0;
          c.lane = to;
          c.last_change = crowd_.time();
          a = acceleration(c, there);
          order();
          break;
        }
      }
    }
    c.a += (a < -4 ? 1.0 : std::min(1.0, dt / 0.3)) * (a - c.a);
  }

  void move(Car& c, double dt)
  {
    const double before = c.v;
    c.v = std::max(0.0, c.v + c.a * dt);
    c.s += 0.5 * (before + c.v) * dt;
    if (c.progress < 1)
    {
      c.progress = std::min(1.0, c.progress + progressRate(c) * dt);
    }
    if (c.actor >= 0)
    {
      const Car& ego = cars_.front();
      // Arc lengths of oncoming cars run in the opposite direction.
      const double centre = c.direction > 0 ? ego.s : -ego.s;
      c.s -= window_ * std::round((c.s - centre) / window_);
    }
    place(c);
  }

  /** Rate of progress of a lane change, which takes some four seconds [1/s]. */
  double progressRate(const Car& c) const
  {
    return std::min(0.85, 0.1 * c.v) / world_.highway_lane_width;
  }

  void place(const Car& c)
  {
    const double half = 0.5 * c.wheelbase;
    // Driving on the right: the ego's carriageway is to the right of the centre line.
    const double lateral = world_.highway_median + (c.lane + 0.5) * world_.highway_lane_width -
                           c.change * (1 - eased(c.progress)) +
                           0.15 * std::sin(0.02 * c.s + c.wander);
    const auto at = [&](double s)
    {
      const auto p = world_.highway.at(c.direction > 0 ? s : -s);
      const double heading = p.heading + (c.direction > 0 ? 0 : 3.14159265358979);
      return Eigen::Vector2d(p.position +
                             lateral * Eigen::Vector2d(std::sin(heading), -std::cos(heading)));
    };
    const Eigen::Vector2d front = at(c.s + half), back = at(c.s - half);
    double yaw = std::atan2(front.y() - back.y(), front.x() - back.x());
    const double sideways = c.change * easedSlope(c.progress) * progressRate(c);  // [m/s], right
    yaw -= std::atan2(sideways, std::max(c.v, 0.1));
    const Eigen::Vector2d position = 0.5 * (front + back);
    if (c.actor < 0)
    {
      crowd_.ego() = {position, yaw, c.v};
      return;
    }
    crowd_.setPosition(c.actor, position, yaw);
    crowd_.actor(c.actor).state.speed = c.v;
  }

  Crowd& crowd_;
  const World& world_;
  double window_;
  Rng rng_;
  int lanes_;
  std::vector<Car> cars_;
  std::vector<std::vector<int>> lane_lists_;
  double slow_until_ = -1, next_slow_ = 12;
};
}  // namespace

std::unique_ptr<Crowd::Group> makeHighwayTraffic(Crowd& crowd)
{
  return std::make_unique<HighwayTraffic>(crowd);
}
}  // namespace dyslam::sim
