// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
constexpr double kActiveRadius = 230;
}

double egoCruise(const World& world, const SimulatorOptions& options)
{
  if (options.ego_speed > 0)
  {
    return options.ego_speed;
  }
  switch (world.kind)
  {
    case WorldKind::urban:
      return 11;
    case WorldKind::highway:
      return 27;
    case WorldKind::tunnel:
      return 20;
    case WorldKind::field:
      return 4;
    case WorldKind::downtown:
      return 8;
    case WorldKind::indoor:
      return 1.2;
    case WorldKind::campus:
      break;
  }
  return options.ego == EgoKind::car ? 4 : 1.4;
}

double driverAcceleration(double v, double v0, double gap, double v_leader, double headway)
{
  constexpr double kAccelerate = 1.6, kBrake = 2.2, kJam = 2.0;
  const double wanted =
      kJam +
      std::max(0.0, v * headway + v * (v - v_leader) / (2 * std::sqrt(kAccelerate * kBrake)));
  const double interaction = gap > 0.1 ? wanted / gap : wanted / 0.1;
  // The free-road term is limited to comfortable braking.
  const double free = std::max(-kBrake, kAccelerate * (1 - std::pow(v / std::max(v0, 0.1), 4)));
  return std::max(-8.0, free - kAccelerate * interaction * interaction);
}

double pedalRate(double speed)
{
  constexpr double kPi = 3.14159265358979;
  return speed / 5.2 * 2 * kPi;  // 5.2 m per revolution
}

std::optional<double> bodyAhead(const Crowd& crowd,
                                int self,
                                const Eigen::Vector2d& position,
                                double yaw,
                                double half_width,
                                double reach)
{
  const Eigen::Vector2d forward(std::cos(yaw), std::sin(yaw));
  std::optional<double> best;
  const auto& actors = crowd.actors();
  for (std::size_t i = 0; i < actors.size(); ++i)
  {
    if (static_cast<int>(i) == self || actors[i].frozen)
    {
      continue;
    }
    const Eigen::Vector2d d = actors[i].state.position.head<2>() - position;
    if (std::abs(d.x()) > reach + 5 || std::abs(d.y()) > reach + 5)
    {
      continue;
    }
    const BodyModel& m = crowd.model(static_cast<int>(i));
    // Extent of the other body along and across the line.
    const double turn = actors[i].state.yaw - yaw;
    const double along =
        0.5 * (std::abs(std::cos(turn)) * m.size.x() + std::abs(std::sin(turn)) * m.size.y());
    const double across =
        0.5 * (std::abs(std::sin(turn)) * m.size.x() + std::abs(std::cos(turn)) * m.size.y());
    const double x = forward.dot(d) - along;
    const double y = std::abs(forward.x() * d.y() - forward.y() * d.x()) - across;
    if (forward.dot(d) > 0 && x < reach && y < half_width && (!best || x < *best))
    {
      best = x;
    }
  }
  return best;
}

Crowd::Crowd(const World& world, const SimulatorOptions& options) : world_(world), options_(options)
{
  switch (world.kind)
  {
    case WorldKind::urban:
    case WorldKind::downtown:
      groups_.push_back(makeStreetTraffic(*this, true));
      groups_.push_back(makeBicycles(*this));
      groups_.push_back(makeWalkers(*this));
      break;
    case WorldKind::campus:
    case WorldKind::field:
      groups_.push_back(makePathEgo(*this));
      groups_.push_back(makeStreetTraffic(*this, false));
      groups_.push_back(makeWalkers(*this));
      break;
    case WorldKind::indoor:
      groups_.push_back(makePathEgo(*this));
      groups_.push_back(makeVisitors(*this));
      break;
    case WorldKind::highway:
    case WorldKind::tunnel:
      groups_.push_back(makeHighwayTraffic(*this));
      break;
  }
  alignWithGround();  // also bodies that are too far away to be simulated
}

Crowd::~Crowd() = default;

void Crowd::step(double dt)
{
  for (auto& group : groups_)
  {
    group->step(dt);
  }
  time_ += dt;
}

int Crowd::addActor(int model_index, float paint)
{
  Actor actor;
  actor.model = model_index;
  actor.paint = paint;
  actors_.push_back(actor);
  return static_cast<int>(actors_.size()) - 1;
}

const BodyModel& Crowd::model(int index) const
{
  return world_.bodies[static_cast<std::size_t>(actors_[static_cast<std::size_t>(index)].model)];
}

bool Crowd::active(const Eigen::Vector2d& position) const
{
  return (position - ego_.position).squaredNorm() < kActiveRadius * kActiveRadius;
}

void Crowd::setPosition(int index, const Eigen::Vector2d& position, double yaw)
{
  Actor& a = actor(index);
  a.state.position.head<2>() = position;
  a.state.yaw = yaw;
}

void Crowd::alignWithGround()
{
  for (std::size_t i = 0; i < actors_.size(); ++i)
  {
    if (!actors_[i].frozen)
    {
      alignActor(actors_[i], model(static_cast<int>(i)));
    }
  }
}

void Crowd::alignActor(Actor& a, const BodyModel& m) const
{
  const Ground& ground = *world_.ground;
  const Eigen::Vector2d position = a.state.position.head<2>();
  if (m.gait == BodyModel::Gait::walking)
  {
    a.state.position.z() = ground.height(position);
    return;
  }
  const Eigen::Vector2d forward(std::cos(a.state.yaw), std::sin(a.state.yaw));
  const double h = 0.5 * m.wheelbase;
  const double front = ground.height(position + h * forward);
  const double back = ground.height(position - h * forward);
  a.state.position.z() = 0.5 * (front + back);
  a.state.pitch = -std::atan2(front - back, 2 * h);
  if (m.size.y() > 1)
  {
    const Eigen::Vector2d left(-forward.y(), forward.x());
    const double w = 0.4 * m.size.y();
    const double port = ground.height(position + w * left);
    a.state.roll = std::atan2(port - ground.height(position - w * left), 2 * w);
  }
}
}  // namespace dyslam::sim
