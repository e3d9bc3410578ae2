// SPDX-License-Identifier: BSD-3-Clause
#include "Scenarios.h"

#include <dyslam/nets/BevScan.h>
#include <dyslam/train/DysegBodies.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace dyslam
{
namespace
{
constexpr int scans = 19;
constexpr std::size_t first_evaluated = 10;
constexpr double period = 0.1;  // time between scans [s]
constexpr double half_turn = 3.14159265358979;

/** A body that moves along a straight line. */
struct Actor
{
  BodyKind kind = BodyKind::car;
  double x = 0;  //!< position at 0 s, sensor frame of the first evaluated scan [m]
  double y = 0;
  double heading = 0;  //!< [rad]
  std::function<double(double)>
      distance;  //!< distance along the heading since 0 s [m], as a function of time [s]
};

std::function<double(double)> at(double speed)
{
  return [speed](double t) { return speed * t; };
}

/** Distance of an actor at rest until `start`, then accelerating uniformly. */
std::function<double(double)> starting(double start, double acceleration)
{
  return [=](double t)
  {
    const double moving = std::max(0.0, t - start);
    return 0.5 * acceleration * moving * moving;
  };
}

/** Distance of an actor that decelerates uniformly to rest at `stop`. */
std::function<double(double)> stopping(double stop, double speed, double braking)
{
  return [=](double t)
  {
    const double left = std::clamp(stop - t, 0.0, speed / braking);
    const double to_go = 0.5 * braking * left * left;
    const double before = std::max(0.0, stop - speed / braking - t) * speed;
    return -(to_go + before);
  };
}

/** Renders an actor into all scans of a clip. Time 0 is the first evaluated scan. */
void render(const Actor& actor, std::int32_t id, DysegClip& clip)
{
  RandomDraws shape(17, static_cast<std::uint64_t>(id));
  const CastBody body = makeBody(actor.kind, shape);
  const Pose T_world_stage = clip.frames[first_evaluated].T_world_sensor;
  for (std::size_t f = 0; f < clip.frames.size(); ++f)
  {
    auto& frame = clip.frames[f];
    const double time = period * (static_cast<double>(f) - static_cast<double>(first_evaluated));
    const double distance = actor.distance(time);
    const double speed = (actor.distance(time + 0.05) - actor.distance(time - 0.05)) / 0.1;
    const Pose place =
        frame.T_world_sensor.inverse() * T_world_stage *
        poseFromYpr(actor.x + distance * std::cos(actor.heading),
                    actor.y + distance * std::sin(actor.heading), 0, actor.heading, 0, 0);
    const Eigen::Vector2d flat = place.translation().head<2>();
    const BevGround ground(frame.points);
    const double height =
        ground.heightAt(static_cast<float>(flat.x()), static_cast<float>(flat.y()));
    DysegClip::Object object;
    object.T_sensor_object = poseFromYpr(flat.x(), flat.y(), height, yawPitchRoll(place).x(), 0, 0);
    object.moving = std::abs(speed) > min_moving_speed;
    object.doubtful = !object.moving && std::abs(speed) > min_cast_moving_speed;
    RandomDraws noise(static_cast<std::uint64_t>(id), f);
    const auto hit = castBody(body, object.T_sensor_object, 0.02F, noise, frame.points);
    frame.objects[id] = object;
    for (const auto i : hit)
    {
      frame.object[i] = id;
    }
  }
}

/** Cars around the sensor with the sensor's speed. */
std::vector<Actor> queue(double speed)
{
  std::vector<Actor> actors;
  for (const double y : {-3.2, 0.0, 3.2})
  {
    for (int k = -3; k <= 4; ++k)
    {
      if (y == 0.0 && k == 0)
      {
        continue;
      }
      const double x = 7.5 * k + (y > 0 ? 2.0 : 0.5);
      actors.push_back({k % 3 == 0 ? BodyKind::van : BodyKind::car, x, y, 0, at(speed)});
    }
  }
  return actors;
}

/** Speed of the sensor at the first evaluated scan [m/s]. */
double egoSpeed(const DysegClip& clip)
{
  const Pose step = clip.frames[first_evaluated].T_world_sensor.inverse() *
                    clip.frames[first_evaluated + 1].T_world_sensor;
  return step.translation().norm() / period;
}

std::vector<Actor> pedestrians(double distance, double speed)
{
  return {{BodyKind::pedestrian, distance, -3, 0.5 * half_turn, at(speed)},
          {BodyKind::pedestrian, distance + 1, 3, -0.5 * half_turn, at(speed)},
          {BodyKind::pedestrian, distance - 2, 1, half_turn, at(speed)}};
}

using Cast = std::function<std::vector<Actor>(const DysegClip&)>;

const std::vector<std::pair<std::string, Cast>>& casts()
{
  const auto fixed = [](std::vector<Actor> actors)
  { return [actors](const DysegClip&) { return actors; }; };
  static const std::vector<std::pair<std::string, Cast>> all{
      {"parked cars", fixed({{BodyKind::car, 12, 3, 0, at(0)},
                             {BodyKind::van, 20, -3, half_turn, at(0)},
                             {BodyKind::car, -9, 3, 0, at(0)}})},
      {"stopped 1 s ago", fixed({{BodyKind::car, 14, 3, 0, stopping(-1, 8, 4)},
                                 {BodyKind::car, 14, -3, half_turn, stopping(-1, 8, 4)}})},
      {"starting, 2 m/s2", fixed({{BodyKind::car, 12, 3, 0, starting(-0.6, 2)},
                                  {BodyKind::van, 18, -3, half_turn, starting(-0.6, 2)}})},
      {"oncoming, 12 m/s", fixed({{BodyKind::car, 25, 3, half_turn, at(12)},
                                  {BodyKind::truck, 45, 3, half_turn, at(12)}})},
      {"crossing, 7 m/s", fixed({{BodyKind::car, 18, -6, 0.5 * half_turn, at(7)},
                                 {BodyKind::cyclist, 12, 4, -0.5 * half_turn, at(5)}})},
      {"creeping, 1 m/s",
       fixed({{BodyKind::car, 10, 3, 0, at(1)}, {BodyKind::truck, 16, -3, half_turn, at(1)}})},
      {"surrounding queue",
       [](const DysegClip& clip) { return queue(std::max(2.0, egoSpeed(clip))); }},
      {"pedestrians at 15 m", fixed(pedestrians(15, 1.4))},
      {"pedestrians at 30 m", fixed(pedestrians(30, 1.4))}};
  return all;
}
}  // namespace

std::vector<Scenario> makeScenarios(std::uint64_t seed, int streets)
{
  std::vector<DysegClip> stages;
  DysegClipScene empty;
  empty.traffic = 0;
  for (int k = 0; k < streets; ++k)
  {
    stages.push_back(simulateClip(seed + static_cast<std::uint64_t>(k), scans, true, empty));
  }
  std::vector<Scenario> scenarios;
  for (const auto& [name, cast] : casts())
  {
    Scenario scenario;
    scenario.name = name;
    for (const auto& stage : stages)
    {
      SegmentationSet set{name, stage, first_evaluated};
      std::int32_t id = 9001;
      for (const auto& actor : cast(stage))
      {
        render(actor, id++, set.clip);
      }
      scenario.sets.push_back(std::move(set));
    }
    scenarios.push_back(std::move(scenario));
  }
  return scenarios;
}
}  // namespace dyslam
