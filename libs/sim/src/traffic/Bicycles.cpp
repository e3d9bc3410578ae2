// SPDX-License-Identifier: BSD-3-Clause
// Cyclists on streets.
#include <algorithm>
#include <cmath>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
/** Cyclists on closed paths at the edge of the carriageway. */
class Bicycles : public Crowd::Group
{
 public:
  explicit Bicycles(Crowd& crowd)
      : crowd_(crowd), rng_(combine(crowd.options().trafficSeed(), 0xB1C1))
  {
    if (crowd.options().traffic <= 0)
    {
      return;
    }
    const double spacing = 45 / crowd.options().traffic;
    for (const auto& loop : crowd.world().bicycle_loops)
    {
      for (double s = rng_.uniform(0, 1) * spacing; s < loop.length() - 6;
           s += spacing * rng_.uniform(0.5, 1.5) + 5)
      {
        Rider r;
        r.loop = &loop;
        r.s = s;
        r.desired_speed = rng_.uniform(3.2, 6.5);
        r.v = r.desired_speed;
        const auto& kinds = crowd.world().cyclists;
        const float paint = drawPaint(rng_);
        r.actor = crowd.addActor(rng_.pick(kinds), paint);
        riders_.push_back(r);
        const auto at = loop.at(s);
        crowd.setPosition(r.actor, at.position, at.heading);
      }
    }
  }

  void step(double dt) override
  {
    for (auto& r : riders_)
    {
      const auto at = r.loop->at(r.s);
      const bool active = crowd_.active(at.position);
      Actor& actor = crowd_.actor(r.actor);
      actor.frozen = !active;
      if (!active)
      {
        continue;
      }
      const auto gap = bodyAhead(crowd_, r.actor, at.position, at.heading, 0.35, 8);
      double desired_speed = r.desired_speed;
      if (gap && r.stuck < 4)
      {
        desired_speed = std::min(desired_speed, std::max(0.0, 0.9 * (*gap - 1.4)));
      }
      const double heading_change = std::abs(wrapToPi(r.loop->at(r.s + 4).heading - at.heading));
      desired_speed = heading_change > 0.3 ? std::min(desired_speed, 2.8) : desired_speed;
      r.stuck = r.v < 0.2 ? r.stuck + dt : std::max(0.0, r.stuck - 0.3 * dt);
      r.v += std::clamp(desired_speed - r.v, -3 * dt, 1.0 * dt);
      r.v = std::max(0.0, r.v);
      r.s += r.v * dt;
      const auto now = r.loop->at(r.s);
      crowd_.setPosition(r.actor, now.position, now.heading);
      actor.state.roll = 0;
      actor.state.speed = r.v;
      actor.state.phase += pedalRate(r.v) * dt;
    }
  }

 private:
  struct Rider
  {
    const Path* loop = nullptr;
    int actor = 0;
    double s = 0, v = 0, desired_speed = 4, stuck = 0;
  };
  Crowd& crowd_;
  Rng rng_;
  std::vector<Rider> riders_;
};
}  // namespace

std::unique_ptr<Crowd::Group> makeBicycles(Crowd& crowd)
{
  return std::make_unique<Bicycles>(crowd);
}
}  // namespace dyslam::sim
