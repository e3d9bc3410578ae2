// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <algorithm>

#include "ObjectGraph.h"

namespace dyslam
{
namespace
{
/** Covariances of a chain of poses are computed in pieces of this size, conditioned on the poses
 * beyond a margin, whose influence is negligible. */
constexpr std::size_t piece_size = 30;
constexpr std::size_t margin = 10;

/** Covariance of x, y, z, yaw in the map frame from the one over the tangent of a level pose. */
Eigen::Matrix4d levelCovariance(const Matrix6& tangent, const Pose& pose)
{
  Eigen::Matrix<double, 4, 6> J = Eigen::Matrix<double, 4, 6>::Zero();
  J.topLeftCorner<3, 3>() = pose.linear();
  J(3, 5) = 1;
  return J * tangent * J.transpose();
}
}  // namespace

/** The velocity at a scan is the mean of these, over the intervals before and after it. */
std::vector<Key> ObjectGraph::velocitiesAt(int id, const Object& object, std::size_t i) const
{
  std::vector<Key> keys;
  for (std::size_t k = i; k < std::min(i + 2, object.in_graph); ++k)
  {
    const Key key = Key::objectVelocity(id, object.observations[k].scan);
    if (graph_.contains(key))
    {
      keys.push_back(key);
    }
  }
  return keys;
}

void ObjectGraph::appendSmoothed(const ObjectKey& object_key,
                                 const Object& object,
                                 std::vector<SmoothedObject>& result) const
{
  for (std::size_t i = 0; i < object.in_graph; ++i)
  {
    const Observation& observation = object.observations[i];
    SmoothedObject smoothed;
    smoothed.id = object_key.first;
    smoothed.scan = observation.scan;
    smoothed.stamp = observation.stamp;
    smoothed.moving = object.state == State::moving;
    if (!smoothed.moving)
    {
      smoothed.T_map_object = graph_.pose(staticKey(object_key));
      result.push_back(smoothed);
      continue;
    }
    smoothed.T_map_object = graph_.pose(Key::objectPose(object_key.first, observation.scan));
    const std::vector<Key> velocities = velocitiesAt(object_key.first, object, i);
    Vector6 twist = Vector6::Zero();
    for (const Key& key : velocities)
    {
      twist += graph_.vector(key);
    }
    smoothed.velocity = smoothed.T_map_object.linear() * twist.head<3>() /
                        static_cast<double>(std::max<std::size_t>(1, velocities.size()));
    result.push_back(smoothed);
  }
}

/** Sets the covariances of these variables, conditioned on all that are not in `free`. */
void ObjectGraph::fillCovariances(const std::set<Key>& free,
                                  std::map<Key, Matrix6>& covariances) const
{
  std::vector<Key> keys;
  for (const auto& [key, covariance] : covariances)
  {
    keys.push_back(key);
  }
  const std::vector<Matrix6> found = graph_.covariances(keys, free);
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    covariances.at(keys[i]) = found[i];
  }
}

void ObjectGraph::addCovariances(const ObjectKey& object_key,
                                 const Object& object,
                                 std::vector<SmoothedObject>& result) const
{
  const std::size_t offset = result.size() - object.in_graph;
  if (object.state == State::stationary)
  {
    const Key key = staticKey(object_key);
    const Eigen::Matrix4d covariance =
        levelCovariance(graph_.covariances({key}, {key}).front(), graph_.pose(key));
    for (std::size_t i = offset; i < result.size(); ++i)
    {
      result[i].covariance = covariance;
    }
    return;
  }
  for (std::size_t first = 0; first < object.in_graph; first += piece_size)
  {
    const std::size_t last = std::min(object.in_graph, first + piece_size);
    std::set<Key> free;
    appendVariables(object_key.first, object, first - std::min(first, margin),
                    std::min(object.in_graph, last + margin), free);
    std::map<Key, Matrix6> covariances;
    for (std::size_t i = first; i < last; ++i)
    {
      covariances.emplace(Key::objectPose(object_key.first, object.observations[i].scan),
                          Matrix6::Zero());
      for (const Key& key : velocitiesAt(object_key.first, object, i))
      {
        covariances.emplace(key, Matrix6::Zero());
      }
    }
    fillCovariances(free, covariances);
    for (std::size_t i = first; i < last; ++i)
    {
      SmoothedObject& smoothed = result[offset + i];
      const Key pose_key = Key::objectPose(object_key.first, smoothed.scan);
      smoothed.covariance = levelCovariance(covariances.at(pose_key), smoothed.T_map_object);
      const Eigen::Matrix3d& R = smoothed.T_map_object.linear();
      const std::vector<Key> velocities = velocitiesAt(object_key.first, object, i);
      for (const Key& key : velocities)
      {
        smoothed.velocity_covariance += R * covariances.at(key).topLeftCorner<3, 3>() *
                                        R.transpose() / static_cast<double>(velocities.size());
      }
    }
  }
}

std::vector<SmoothedObject> ObjectGraph::smoothed() const
{
  std::vector<SmoothedObject> result;
  for (const auto& [key, object] : objects_)
  {
    appendSmoothed(key, object, result);
    if (object.in_graph > 0)
    {
      addCovariances(key, object, result);
    }
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b)
                   { return a.scan < b.scan || (a.scan == b.scan && a.id < b.id); });
  return result;
}
}  // namespace dyslam
