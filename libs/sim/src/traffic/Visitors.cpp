// SPDX-License-Identifier: BSD-3-Clause
// People and cleaning machines in a building. They walk by the social force model (Helbing and
// Molnar, 1995), with evasion ahead of an encounter, on the free floor of World::floor_plan.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;
constexpr double kReach = 3;         // distance at which bodies act on each other [m]
constexpr double kServed = 0.85;     // distance between places of a queue [m]
constexpr double kCorridor = 0.10;   // people on each square metre of a way in the densest traffic
constexpr double kEgoRadius = 0.45;  // [m]

P rightOf(const P& d)
{
  return {d.y(), -d.x()};
}

struct Visitor
{
  enum class Mode
  {
    walks,
    stands,  //!< for all the recording
    queues
  };
  Mode mode = Mode::walks;
  int actor = 0;
  double radius = 0.25;     //!< [m]
  double clearance = 0.25;  //!< least distance of the centre from walls [m]
  bool machine = false;
  int from = 0, to = 0, link = 0, next_link = 0;
  double side = 0.4;  //!< offset to the right of a way, as a fraction of half its width
  double desired_speed = 1.3;
  P position = P::Zero(), velocity = P::Zero(), target = P::Zero();
  double yaw = 0;
  double pause_until = 0, stuck = 0;
};

class Visitors : public Crowd::Group
{
 public:
  explicit Visitors(Crowd& crowd)
      : crowd_(crowd),
        net_(crowd.world().walks),
        plan_(crowd.world().floor_plan),
        rng_(combine(crowd.options().trafficSeed(), 0x7151707))
  {
    if (crowd.options().traffic > 0)
    {
      addWalkers();
      addGroups();
      addQueues();
      addMachines();
    }
  }

  void step(double dt) override
  {
    advanceQueues();
    sortIntoCells();
    for (std::size_t i = 0; i < visitors_.size(); ++i)
    {
      if (visitors_[i].mode != Visitor::Mode::stands)
      {
        walk(i, dt);
      }
    }
  }

 private:
  struct Queue
  {
    QueueSpot spot;
    std::vector<std::size_t> members;  // in `visitors_`, the first is served
    double next = 0;                   // time at which the first leaves
  };

  const P& node(int i) const { return net_.nodes[static_cast<std::size_t>(i)]; }
  const WalkNetwork::Link& linkAt(int i) const { return net_.links[static_cast<std::size_t>(i)]; }
  int other(int link, int from) const
  {
    return linkAt(link).a == from ? linkAt(link).b : linkAt(link).a;
  }
  bool isDeadEnd(int n) const { return net_.links_of_node[static_cast<std::size_t>(n)].size() < 2; }

  double distanceToEgoPath(const P& p) const
  {
    double least = 1e9;
    for (const P& q : crowd_.world().ego_path.points())
    {
      least = std::min(least, (p - q).squaredNorm());
    }
    return std::sqrt(least);
  }

  /** Whether nobody is within a distance of a position. */
  bool isFree(const P& p, double distance) const
  {
    return std::none_of(visitors_.begin(), visitors_.end(),
                        [&](const Visitor& v) { return (v.position - p).norm() < distance; }) &&
           (crowd_.ego().position - p).norm() > distance + kEgoRadius;
  }

  /** A person at a position. */
  Visitor person(const P& position, double luggage_share)
  {
    const World& world = crowd_.world();
    Visitor v;
    const bool luggage = rng_.chance(luggage_share);
    const int model = luggage ? rng_.pick(world.travellers) : rng_.pick(world.people);
    v.actor = crowd_.addActor(model, drawPaint(rng_));
    v.clearance = luggage ? 0.35 : 0.25;
    v.radius = luggage ? 0.35 : 0.25;
    v.position = position;
    v.desired_speed = std::clamp(1.25 + 0.25 * rng_.gaussian(), 0.6, 1.9);
    v.side = rng_.uniform(0.05, 0.95);
    v.yaw = rng_.uniform(-M_PI, M_PI);
    crowd_.actor(v.actor).state.phase = rng_.uniform(0, 2 * M_PI);
    return v;
  }

  void show(const Visitor& v)
  {
    crowd_.setPosition(v.actor, v.position, v.yaw);
    crowd_.actor(v.actor).state.speed = v.velocity.norm();
  }

  void addWalkers()
  {
    for (std::size_t l = 0; l < net_.links.size(); ++l)
    {
      const auto& link = net_.links[l];
      const P a = node(link.a), b = node(link.b);
      const double per_metre = kCorridor * std::max(1.5, 1.6 * link.width);
      const double expected = crowd_.options().traffic * (b - a).norm() * per_metre;
      const int count =
          static_cast<int>(expected) + (rng_.chance(expected - std::floor(expected)) ? 1 : 0);
      for (int k = 0; k < count; ++k)
      {
        const bool forward = rng_.chance(0.5);
        const double along = rng_.uniform(), across = rng_.uniform(0, 0.9);
        const P from = forward ? a : b, to = forward ? b : a;
        const P d = (to - from).normalized();
        const P position = from + along * (to - from) + 0.5 * across * link.width * rightOf(d);
        if (plan_.clearance(position) < 0.4 || !isFree(position, 0.8))
        {
          continue;
        }
        Visitor v = person(position, 0.25);
        v.link = static_cast<int>(l);
        v.from = forward ? link.a : link.b;
        v.to = forward ? link.b : link.a;
        v.side = across;
        v.velocity = v.desired_speed * d;
        v.yaw = std::atan2(d.y(), d.x());
        chooseNext(v);
        visitors_.push_back(v);
        crowd_.actor(v.actor).state.swing = 1;
        show(v);
      }
    }
  }

  /** Groups of people who stand and talk, beside the ego's path. */
  void addGroups()
  {
    double length = 0;
    for (const auto& link : net_.links)
    {
      length += (node(link.b) - node(link.a)).norm();
    }
    const int groups = static_cast<int>(crowd_.options().traffic * length / 14);
    for (int g = 0, attempt = 0; g < groups && attempt < 20 * groups; ++attempt)
    {
      const auto& link =
          net_.links[static_cast<std::size_t>(rng_.below(static_cast<int>(net_.links.size())))];
      const double along = rng_.uniform(), across = rng_.uniform(-3, 3);
      const P a = node(link.a), b = node(link.b);
      const P centre = a + along * (b - a) + across * rightOf((b - a).normalized());
      const int people = 2 + rng_.below(3);
      const double radius = rng_.uniform(0.45, 0.65) + 0.08 * people;
      if (plan_.clearance(centre) < radius + 0.35 || distanceToEgoPath(centre) < radius + 1.3 ||
          !isFree(centre, radius + 0.8))
      {
        continue;
      }
      ++g;
      const double turn = rng_.uniform(0, 2 * M_PI);
      for (int k = 0; k < people; ++k)
      {
        const double angle = turn + 2 * M_PI * k / people + rng_.uniform(-0.25, 0.25);
        Visitor v = person(centre + radius * P(std::cos(angle), std::sin(angle)), 0);
        v.yaw = wrapToPi(angle + M_PI + rng_.uniform(-0.4, 0.4));
        v.mode = Visitor::Mode::stands;
        visitors_.push_back(v);
        show(v);
      }
    }
  }

  void addQueues()
  {
    for (const QueueSpot& spot : crowd_.world().queues)
    {
      Queue queue;
      queue.spot = spot;
      queue.next = rng_.uniform(3, 15);
      const int members = static_cast<int>(std::lround(
          spot.places * std::min(1.0, crowd_.options().traffic * rng_.uniform(0.8, 2.2))));
      for (int k = 0; k < members; ++k)
      {
        const P place = spot.head + kServed * k * spot.direction;
        if (!isFree(place, 0.5))
        {
          break;
        }
        Visitor v = person(place, 0.3);
        v.mode = Visitor::Mode::queues;
        v.yaw = k == 0 ? M_PI_2 : std::atan2(-spot.direction.y(), -spot.direction.x());
        queue.members.push_back(visitors_.size());
        visitors_.push_back(v);
        show(v);
      }
      queues_.push_back(queue);
    }
  }

  void addMachines()
  {
    std::vector<int> wide;
    for (std::size_t l = 0; l < net_.links.size(); ++l)
    {
      if (net_.links[l].width > 2)
      {
        wide.push_back(static_cast<int>(l));
      }
    }
    const int count = 1 + static_cast<int>(std::lround(2 * crowd_.options().traffic));
    for (int k = 0; k < count && !wide.empty(); ++k)
    {
      const int l = rng_.pick(wide);
      const P position = 0.5 * (node(linkAt(l).a) + node(linkAt(l).b)) +
                         0.6 * rightOf((node(linkAt(l).b) - node(linkAt(l).a)).normalized());
      if (!isFree(position, 1.2) || plan_.clearance(position) < 0.8)
      {
        continue;
      }
      Visitor v;
      v.machine = true;
      v.radius = 0.6;
      v.clearance = 0.7;
      v.actor = crowd_.addActor(rng_.pick(crowd_.world().machines), drawPaint(rng_));
      v.desired_speed = rng_.uniform(0.6, 0.9);
      v.side = rng_.uniform(0.2, 0.6);
      v.link = l;
      v.from = linkAt(l).a;
      v.to = linkAt(l).b;
      v.position = position;
      const P d = (node(v.to) - node(v.from)).normalized();
      v.yaw = std::atan2(d.y(), d.x());
      chooseNext(v);
      visitors_.push_back(v);
      show(v);
    }
  }

  /** Chooses the way after `to`, and as target the corner that a walker on its side of both ways
   * passes. Few turn into a room that they pass. */
  void chooseNext(Visitor& v)
  {
    const auto& links = net_.links_of_node[static_cast<std::size_t>(v.to)];
    v.next_link = v.link;
    for (int attempt = 0; attempt < 8 && v.next_link == v.link; ++attempt)
    {
      const int candidate =
          links[static_cast<std::size_t>(rng_.below(static_cast<int>(links.size())))];
      const bool drawn = rng_.chance(0.2);
      const bool room = isDeadEnd(other(candidate, v.to));
      v.next_link = room && (v.machine || !drawn) ? v.link : candidate;
    }
    const P d0 = (node(v.to) - node(v.from)).normalized(),
            d1 = (node(other(v.next_link, v.to)) - node(v.to)).normalized();
    const double offset = 0.5 * v.side * std::min(linkAt(v.link).width, linkAt(v.next_link).width);
    const P r0 = rightOf(d0), r1 = rightOf(d1);
    const double along = 1 + r0.dot(r1);
    v.target = node(v.to) + (along > 0.4 ? P(offset * (r0 + r1) / along) : P(offset * r1));
    if (plan_.clearance(v.target) < v.clearance + 0.1)
    {
      v.target = node(v.to);
    }
  }

  void turnBack(Visitor& v)
  {
    std::swap(v.from, v.to);
    chooseNext(v);
  }

  /** Sends the person who was served away and lets the nearest walker join the queue. */
  void advanceQueues()
  {
    for (Queue& queue : queues_)
    {
      if (crowd_.time() < queue.next)
      {
        continue;
      }
      queue.next = crowd_.time() + rng_.uniform(8, 25);
      if (!queue.members.empty())
      {
        leave(visitors_[queue.members.front()]);
        queue.members.erase(queue.members.begin());
        join(queue);
      }
    }
  }

  void leave(Visitor& v)
  {
    double nearest = 1e9;
    for (std::size_t l = 0; l < net_.links.size(); ++l)
    {
      const P middle = 0.5 * (node(net_.links[l].a) + node(net_.links[l].b));
      const double distance = (middle - v.position).norm();
      if (distance < nearest && plan_.isClear(v.position, node(net_.links[l].b), v.clearance))
      {
        nearest = distance;
        v.link = static_cast<int>(l);
        v.from = net_.links[l].a;
        v.to = net_.links[l].b;
      }
    }
    if (nearest < 1e9)
    {
      v.mode = Visitor::Mode::walks;
      chooseNext(v);
    }
  }

  void join(Queue& queue)
  {
    const P place = queue.spot.head +
                    kServed * static_cast<double>(queue.members.size()) * queue.spot.direction;
    std::size_t best = visitors_.size();
    double nearest = 12;
    for (std::size_t i = 0; i < visitors_.size(); ++i)
    {
      const Visitor& v = visitors_[i];
      const double distance = (v.position - place).norm();
      if (v.mode == Visitor::Mode::walks && !v.machine && distance < nearest &&
          plan_.isClear(v.position, place, v.clearance))
      {
        nearest = distance;
        best = i;
      }
    }
    if (best < visitors_.size())
    {
      visitors_[best].mode = Visitor::Mode::queues;
      queue.members.push_back(best);
    }
  }

  static std::pair<int, int> cellOf(const P& p)
  {
    return {static_cast<int>(std::floor(p.x() / kReach)),
            static_cast<int>(std::floor(p.y() / kReach))};
  }

  void sortIntoCells()
  {
    cells_.clear();
    for (std::size_t i = 0; i < visitors_.size(); ++i)
    {
      cells_[cellOf(visitors_[i].position)].push_back(i);
    }
    for (Queue& queue : queues_)
    {
      for (std::size_t k = 0; k < queue.members.size(); ++k)
      {
        visitors_[queue.members[k]].target =
            queue.spot.head + kServed * static_cast<double>(k) * queue.spot.direction;
      }
    }
  }

  /** Acceleration by another body. \param position, velocity, radius of the other */
  static P push(const Visitor& v, const P& position, const P& velocity, double radius)
  {
    const P offset = v.position - position;
    const double distance = std::max(0.05, offset.norm()), reach = v.radius + radius;
    if (distance > kReach)
    {
      return P::Zero();
    }
    const P away = offset / distance;
    const double speed = v.velocity.norm();
    const double ahead = speed > 0.05 ? -away.dot(v.velocity) / speed : 0;
    const double sight = 0.3 + 0.35 * (1 + ahead);  // what is behind has less effect
    P a = 2.1 * sight * std::exp((reach - distance) / 0.3) * away;
    // Evasion before the bodies are nearest to each other.
    const P relative = v.velocity - velocity;
    const double closing = relative.squaredNorm();
    const double time = closing > 0.01 ? -offset.dot(relative) / closing : -1;
    if (time > 0 && time < 2.5 && ahead > 0 && speed > 0.05)
    {
      const P nearest = offset + time * relative;
      if (nearest.norm() < reach + 0.3)
      {
        const P right = rightOf(v.velocity / speed);
        const double lateral = nearest.dot(right);
        a += (1 - time / 2.5) * (lateral < -0.2 ? -1.3 : 1.3) * right;
      }
    }
    return a;
  }

  P acceleration(std::size_t index, const P& desired_velocity) const
  {
    const Visitor& v = visitors_[index];
    P a = (desired_velocity - v.velocity) / 0.5;
    const auto [x, y] = cellOf(v.position);
    for (int dx = -1; dx <= 1; ++dx)
    {
      for (int dy = -1; dy <= 1; ++dy)
      {
        const auto cell = cells_.find({x + dx, y + dy});
        if (cell == cells_.end())
        {
          continue;
        }
        for (const std::size_t i : cell->second)
        {
          if (i != index)
          {
            a += push(v, visitors_[i].position, visitors_[i].velocity, visitors_[i].radius);
          }
        }
      }
    }
    const EgoState& ego = crowd_.ego();
    a += push(v, ego.position, ego.speed * P(std::cos(ego.yaw), std::sin(ego.yaw)), kEgoRadius);
    const double room = plan_.clearance(v.position) - v.clearance;
    if (room < 0.4)
    {
      a += 4 * (1 - std::max(0.0, room) / 0.4) * plan_.away(v.position);
    }
    return a;
  }

  /** Desired velocity on the way to the target. */
  P desiredVelocity(Visitor& v, double dt)
  {
    const P d = v.target - v.position;
    if (v.mode == Visitor::Mode::queues)
    {
      return d.norm() < 0.1 ? P::Zero() : P(std::min(1.0, 1.2 * d.norm()) * d.normalized());
    }
    const P way = (node(v.to) - node(v.from)).normalized();
    if (d.norm() < 0.6 || (d.norm() < 2 && d.dot(way) < 0))
    {
      if (isDeadEnd(v.to))
      {
        v.pause_until = crowd_.time() + rng_.uniform(4, 25);
      }
      v.from = v.to;
      v.to = other(v.next_link, v.from);
      v.link = v.next_link;
      chooseNext(v);
    }
    if (rng_.chance(0.006 * dt))
    {
      v.pause_until = crowd_.time() + rng_.uniform(2, 8);
    }
    if (crowd_.time() < v.pause_until)
    {
      return P::Zero();
    }
    v.stuck = v.velocity.norm() < 0.1 ? v.stuck + dt : 0;
    if (v.stuck > 4)
    {
      v.stuck = 0;
      turnBack(v);
    }
    return v.desired_speed * (v.target - v.position).normalized();
  }

  void walk(std::size_t index, double dt)
  {
    Visitor& v = visitors_[index];
    const P desired = desiredVelocity(v, dt);
    v.velocity += dt * acceleration(index, desired);
    const double fastest = v.machine ? 1.0 : 1.3 * v.desired_speed;
    if (v.velocity.norm() > fastest)
    {
      v.velocity *= fastest / v.velocity.norm();
    }
    if (desired.isZero() && v.velocity.norm() < 0.08)
    {
      v.velocity.setZero();
    }
    move(v, dt);
    turn(v, dt);
    animate(v, dt);
    show(v);
  }

  /** Moves, along walls where there is one. */
  void move(Visitor& v, double dt) const
  {
    const P next = v.position + dt * v.velocity;
    const double room = plan_.clearance(next);
    if (room >= v.clearance || room > plan_.clearance(v.position))
    {
      v.position = next;
      return;
    }
    const P away = plan_.away(v.position);
    const double into = std::min(0.0, v.velocity.dot(away));
    v.velocity -= into * away;
    const P beside = v.position + dt * v.velocity;
    if (plan_.clearance(beside) >= std::min(v.clearance, plan_.clearance(v.position)))
    {
      v.position = beside;
    }
    else
    {
      v.velocity.setZero();
    }
  }

  static void turn(Visitor& v, double dt)
  {
    const double speed = v.velocity.norm();
    if (speed > 0.12)
    {
      const double off = wrapToPi(std::atan2(v.velocity.y(), v.velocity.x()) - v.yaw);
      const double most = (v.machine ? 1.2 : 4) * dt * std::min(1.0, 2 * speed);
      v.yaw = wrapToPi(v.yaw + std::clamp(off, -most, most));
    }
  }

  void animate(const Visitor& v, double dt)
  {
    if (v.machine)
    {
      return;
    }
    BodyState& state = crowd_.actor(v.actor).state;
    const double speed = v.velocity.norm();
    // A stride of two steps is about 0.85 body heights at full speed.
    state.phase += 2 * M_PI * speed / (0.55 + 0.65 * speed) * dt;
    const double swing = speed > 0.05 ? std::min(1.0, 0.25 + 0.6 * speed) : 0;
    state.swing += std::clamp(swing - state.swing, -3 * dt, 3 * dt);
  }

  Crowd& crowd_;
  const WalkNetwork& net_;
  const FloorPlan& plan_;
  Rng rng_;
  std::vector<Visitor> visitors_;
  std::vector<Queue> queues_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;  // by position
};
}  // namespace

std::unique_ptr<Crowd::Group> makeVisitors(Crowd& crowd)
{
  return std::make_unique<Visitors>(crowd);
}
}  // namespace dyslam::sim
