// SPDX-License-Identifier: BSD-3-Clause
// Decision whether an object is static or moving.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "ObjectGraph.h"

namespace dyslam
{
namespace
{
/** Number of successive observations that must show an object moving. */
constexpr std::size_t moving_confirmations = 3;
constexpr std::size_t min_for_speed = ObjectGraphOptions::min_for_speed;
}  // namespace

bool ObjectGraph::isStray(const ObjectKey& key,
                          const Object& object,
                          const Observation& observation) const
{
  if (object.state != State::stationary)
  {
    return false;
  }
  const Pose T_map_object =
      graph_.pose(Key::ego(observation.keyframe)) * observation.T_keyframe_object;
  return (T_map_object.translation() - graph_.pose(staticKey(key)).translation()).norm() >
         options_.max_jump;
}

std::vector<PlanarObservation> ObjectGraph::recent(const Object& object,
                                                   double duration,
                                                   std::size_t least) const
{
  std::vector<PlanarObservation> result;
  const Observation& newest = object.observations.back();
  for (auto it = object.observations.rbegin(); it != object.observations.rend(); ++it)
  {
    const bool successive = newest.scan - it->scan == result.size();
    if (newest.time - it->time > duration && !(successive && result.size() < least))
    {
      break;
    }
    const Pose T_map_object = graph_.pose(Key::ego(it->keyframe)) * it->T_keyframe_object;
    const double sigma =
        options_.moving_sigma_scale * std::sqrt(0.5 * it->covariance.topLeftCorner<2, 2>().trace());
    result.push_back({it->time, T_map_object.translation().head<2>(), sigma});
  }
  return result;
}

/** Largest apparent motion of a static object, by noise and drift of the odometry [m]. */
double ObjectGraph::staticLimit(const Object& object) const
{
  const Observation& first = object.observations.front();
  const Observation& last = object.observations.back();
  const double range = first.T_keyframe_object.translation().norm();
  const double variance =
      last.drift - first.drift + (last.drift_angle - first.drift_angle) * range * range;
  return options_.max_static_motion + 2 * std::sqrt(std::max(0.0, variance));
}

bool ObjectGraph::isStanding(const Object& object) const
{
  const double duration = object.observations.back().time - object.observations.front().time;
  if (duration < options_.min_static_time)
  {
    return false;
  }
  // A line through the whole sighting reveals slow motion.
  const auto all = recent(object, duration);
  const SpeedEstimate speed = fitSpeed(all);
  return speed.atMost() < options_.moving_speed &&
         speed.velocity.norm() * duration < staticLimit(object);
}

void ObjectGraph::decide(const ObjectKey& key, Object& object) const
{
  const auto count = static_cast<std::size_t>(options_.min_observations);
  if (object.state == State::moving || object.observations.size() < count)
  {
    return;
  }
  const auto window = recent(object, options_.speed_window, min_for_speed);
  if (window.size() >= min_for_speed)
  {
    const bool fast = fitSpeed(window).atLeast() > options_.moving_speed;
    object.fast = fast ? object.fast + 1 : 0;
  }
  if (object.state == State::stationary && !window.empty())
  {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const PlanarObservation& observation : window)
    {
      mean += observation.position / static_cast<double>(window.size());
    }
    // The landmark is at the mean of its observations: half the motion is visible.
    const double offset = (mean - graph_.pose(staticKey(key)).translation().head<2>()).norm();
    object.away = 2 * offset > staticLimit(object) ? object.away + 1 : 0;
  }
  if (object.fast >= moving_confirmations || object.away >= moving_confirmations)
  {
    object.state = State::moving;
  }
  else if (object.state == State::undecided && object.fast == 0 &&
           (object.landmark || !landmarks_) && isStanding(object))
  {
    object.state = landmarks_ ? State::stationary : State::moving;  // moving: with velocity 0
  }
}
}  // namespace dyslam
