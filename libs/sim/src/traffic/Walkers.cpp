// SPDX-License-Identifier: BSD-3-Clause
// Pedestrians, and cyclists on campus paths.
#include <algorithm>
#include <cmath>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
constexpr double kPi = 3.14159265358979;

bool isMotorised(ObjectClass c)
{
  return c != ObjectClass::pedestrian && c != ObjectClass::cyclist;
}

/** Number of pedestrians and cyclists on each metre of a link in the densest traffic. */
double walkersPerMetre(WorldKind kind)
{
  switch (kind)
  {
    case WorldKind::campus:
      return 0.10;
    case WorldKind::downtown:
      return 0.11;
    case WorldKind::field:
      return 0.01;
    case WorldKind::urban:
      return 0.05;
    case WorldKind::highway:
    case WorldKind::tunnel:
    case WorldKind::indoor:
      break;
  }
  return 0;  // no pavements
}

struct Walker
{
  int actor = 0;
  bool rides = false;
  int from = 0, to = 0, link = 0, next_link = 0;
  double side = 0.4;  // offset to the right of the links' centre line [m]
  double desired_speed = 1.3, v = 0;
  double yaw = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero(), target = Eigen::Vector2d::Zero();
  double pause_until = 0;
  double stuck = 0;
  bool at_rest = false;  // stands still permanently
};

class Walkers : public Crowd::Group
{
 public:
  explicit Walkers(Crowd& crowd)
      : crowd_(crowd),
        net_(crowd.world().walks),
        rng_(combine(crowd.options().trafficSeed(), 0x3A1C))
  {
    if (net_.links.empty() || crowd.options().traffic <= 0)
    {
      return;
    }
    const bool campus = crowd.world().kind == WorldKind::campus;
    const double per_metre = crowd.options().traffic * walkersPerMetre(crowd.world().kind);
    for (std::size_t l = 0; l < net_.links.size(); ++l)
    {
      const auto& link = net_.links[l];
      if (link.crossing)
      {
        continue;
      }
      const double length = (net_.nodes[static_cast<std::size_t>(link.b)] -
                             net_.nodes[static_cast<std::size_t>(link.a)])
                                .norm();
      const double expected = length * per_metre;
      const int count =
          static_cast<int>(expected) + (rng_.chance(expected - std::floor(expected)) ? 1 : 0);
      for (int k = 0; k < count; ++k)
      {
        add(static_cast<int>(l), campus && rng_.chance(0.25));
      }
    }
  }

  void step(double dt) override
  {
    for (auto& w : walkers_)
    {
      const bool active = crowd_.active(w.position);
      crowd_.actor(w.actor).frozen = !active;
      if (active)
      {
        walk(w, dt);
      }
    }
  }

 private:
  const Eigen::Vector2d& node(int i) const { return net_.nodes[static_cast<std::size_t>(i)]; }

  void add(int link_index, bool rides)
  {
    const auto& link = net_.links[static_cast<std::size_t>(link_index)];
    Walker w;
    w.rides = rides;
    const auto& kinds = rides ? crowd_.world().cyclists : crowd_.world().people;
    const float paint = drawPaint(rng_);
    w.actor = crowd_.addActor(rng_.pick(kinds), paint);
    const bool forward = rng_.chance(0.5);
    w.from = forward ? link.a : link.b;
    w.to = forward ? link.b : link.a;
    w.link = link_index;
    w.side = rng_.uniform(0.1, 0.5 * link.width);
    w.desired_speed = rides ? rng_.uniform(2.5, 5.0) : std::max(0.5, 1.3 + 0.3 * rng_.gaussian());
    w.at_rest = !rides && rng_.chance(0.15);
    w.v = w.at_rest ? 0 : w.desired_speed;
    const Eigen::Vector2d d = (node(w.to) - node(w.from)).normalized();
    w.yaw = std::atan2(d.y(), d.x());
    w.position = node(w.from) + rng_.uniform() * (node(w.to) - node(w.from)) +
                 w.side * Eigen::Vector2d(d.y(), -d.x());
    if (w.at_rest)
    {
      w.yaw = rng_.uniform(-kPi, kPi);
    }
    chooseNext(w);
    crowd_.actor(w.actor).state.phase = rng_.uniform(0, 2 * kPi);
    crowd_.actor(w.actor).state.swing = w.at_rest ? 0 : 1;
    walkers_.push_back(w);
    crowd_.setPosition(w.actor, w.position, w.yaw);
    crowd_.actor(w.actor).state.speed = w.v;
  }

  /** Chooses the link after `to`, and as target the corner that a walker on its side of both links
   * passes. */
  void chooseNext(Walker& w)
  {
    const auto& links = net_.links_of_node[static_cast<std::size_t>(w.to)];
    w.next_link = w.link;
    for (int attempt = 0; attempt < 6 && w.next_link == w.link; ++attempt)
    {
      const int candidate =
          links[static_cast<std::size_t>(rng_.below(static_cast<int>(links.size())))];
      const bool crossing = net_.links[static_cast<std::size_t>(candidate)].crossing;
      w.next_link = crossing && !rng_.chance(0.4) ? w.link : candidate;
    }
    const int after = other(w.next_link, w.to);
    const Eigen::Vector2d d0 = (node(w.to) - node(w.from)).normalized(),
                          d1 = (node(after) - node(w.to)).normalized();
    const Eigen::Vector2d r0(d0.y(), -d0.x()), r1(d1.y(), -d1.x());
    const double along = 1 + r0.dot(r1);
    w.target = node(w.to) + (along > 0.4 ? Eigen::Vector2d(w.side * (r0 + r1) / along)
                                         : Eigen::Vector2d(w.side * r1));
  }

  int other(int link, int from) const
  {
    const auto& l = net_.links[static_cast<std::size_t>(link)];
    return l.a == from ? l.b : l.a;
  }

  bool mayCross(int link) const
  {
    const auto& l = net_.links[static_cast<std::size_t>(link)];
    const Eigen::Vector2d middle = 0.5 * (node(l.a) + node(l.b));
    const auto comes = [&](const Eigen::Vector2d& p, double yaw, double speed, double half_length)
    {
      const Eigen::Vector2d d = middle - p;
      const double ahead = d.x() * std::cos(yaw) + d.y() * std::sin(yaw);
      const double distance = d.norm();
      return distance < half_length + 4.5 ||
             (speed > 0.3 && ahead > 0 && distance < half_length + 5 + 4.5 * speed);
    };
    if ((crowd_.world().kind == WorldKind::urban || crowd_.world().kind == WorldKind::downtown) &&
        comes(crowd_.ego().position, crowd_.ego().yaw, crowd_.ego().speed, 2.2))
    {
      return false;
    }
    const auto& actors = crowd_.actors();
    for (std::size_t i = 0; i < actors.size(); ++i)
    {
      const BodyModel& m = crowd_.model(static_cast<int>(i));
      if (!actors[i].frozen && isMotorised(m.object_class) &&
          comes(actors[i].state.position.head<2>(), actors[i].state.yaw, actors[i].state.speed,
                0.5 * m.size.x()))
      {
        return false;
      }
    }
    return true;
  }

  void walk(Walker& w, double dt)
  {
    BodyState& state = crowd_.actor(w.actor).state;
    if (w.at_rest)
    {
      state.swing = 0;
      state.speed = 0;
      return;
    }
    if ((w.target - w.position).norm() < (w.rides ? 1.6 : 0.5))
    {
      continueOrWait(w);
    }
    if (!w.rides && rng_.chance(0.004 * dt))
    {
      w.pause_until = crowd_.time() + rng_.uniform(2, 12);
    }
    const Steering steering = steer(w);
    w.stuck = w.v < 0.15 && crowd_.time() >= w.pause_until ? w.stuck + dt : 0;
    const double rate = w.rides ? 1.5 : 2.5;
    w.v += std::clamp(steering.speed - w.v, -2 * rate * dt, rate * dt);
    const double turn = std::clamp(steering.turn, -1.0, 1.0) * (w.rides ? 1.8 : 3.0);
    w.yaw = wrapToPi(w.yaw + turn * dt * std::min(1.0, 0.2 + w.v));
    w.position += w.v * dt * Eigen::Vector2d(std::cos(w.yaw), std::sin(w.yaw));
    if (w.rides)
    {
      state.phase += pedalRate(w.v) * dt;
      state.roll = 0;
    }
    else
    {
      // A stride of two steps is about 0.85 body heights at full speed.
      state.phase += 2 * kPi * w.v / (0.55 + 0.65 * w.v) * dt;
      state.swing += std::clamp(
          std::min(1.0, 0.25 + 0.6 * w.v) * (w.v > 0.05 ? 1 : 0) - state.swing, -3 * dt, 3 * dt);
    }
    crowd_.setPosition(w.actor, w.position, w.yaw);
    state.speed = w.v;
  }

  /** At the end of a link: continues on the next link, or waits before a crossing that is not free.
   */
  void continueOrWait(Walker& w)
  {
    const auto& next = net_.links[static_cast<std::size_t>(w.next_link)];
    if (!next.crossing || net_.links[static_cast<std::size_t>(w.link)].crossing ||
        mayCross(w.next_link))
    {
      const int after = other(w.next_link, w.to);
      w.from = w.to;
      w.to = after;
      w.link = w.next_link;
      chooseNext(w);
    }
    else
    {
      w.pause_until = crowd_.time() + 0.4;
    }
  }

  struct Steering
  {
    double speed;  //!< desired speed [m/s]
    double turn;   //!< angle from the present heading [rad]
  };

  /** Steers towards the target: slower in corners and behind other bodies, around bodies at rest
   * and the ego. */
  Steering steer(const Walker& w)
  {
    const Eigen::Vector2d d = w.target - w.position;
    const double target_heading = std::atan2(d.y(), d.x());
    double desired_speed = crowd_.time() < w.pause_until ? 0 : w.desired_speed;
    const double off = wrapToPi(target_heading - w.yaw);
    desired_speed *= std::max(0.25, std::cos(std::min(std::abs(off), 1.4)));
    const auto gap =
        bodyAhead(crowd_, w.actor, w.position, w.yaw, w.rides ? 0.45 : 0.3, w.rides ? 3.5 : 1.6);
    double evasion = 0;
    if (gap)
    {
      const double room = w.rides ? 1.2 : 0.5;
      desired_speed =
          std::min(desired_speed, std::max(0.0, 1.2 * (*gap - room)) + (w.stuck > 1.5 ? 0.3 : 0.0));
      evasion = w.stuck > 0.5 || *gap < 1.2 ? -0.7 : -0.35;  // to the right
    }
    const Eigen::Vector2d to_ego = crowd_.ego().position - w.position;
    if (to_ego.norm() < (w.rides ? 2.5 : 1.5) &&
        to_ego.x() * std::cos(w.yaw) + to_ego.y() * std::sin(w.yaw) > 0)
    {
      desired_speed = std::min(desired_speed, 0.5 * w.desired_speed);
      evasion = -0.8;
      desired_speed = to_ego.norm() < 0.9 ? 0.2 : desired_speed;
    }
    return {desired_speed, wrapToPi(target_heading + evasion - w.yaw)};
  }

  Crowd& crowd_;
  const WalkNetwork& net_;
  Rng rng_;
  std::vector<Walker> walkers_;
};
}  // namespace

std::unique_ptr<Crowd::Group> makeWalkers(Crowd& crowd)
{
  return std::make_unique<Walkers>(crowd);
}
}  // namespace dyslam::sim
