// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectGraph.h"

#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/backend/factors/ObservationFactor.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Motion.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "graph/CovarianceInverse.h"

namespace dyslam
{
namespace
{
/** Number of successive distant observations after which a new sighting begins. */
constexpr std::size_t stray_confirmations = 3;
/** Time without observations after which an undecided object is dropped [s]. */
constexpr double forget_after = 5;

Pose poseOf(const Box& box)
{
  return poseFromYpr(box.centre.x(), box.centre.y(), box.centre.z(), box.yaw, 0, 0);
}

/** Covariance over an object pose's tangent from the one of x, y, z, yaw in a level frame. */
Matrix6 tangentCovariance(const Eigen::Matrix4d& covariance, double yaw, double tilt_sigma)
{
  const Eigen::Matrix3d R_object_level =
      Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() =
      R_object_level * covariance.topLeftCorner<3, 3>() * R_object_level.transpose();
  result(3, 3) = result(4, 4) = tilt_sigma * tilt_sigma;
  result(5, 5) = covariance(3, 3);
  return result;
}

/** Pose of the same box with front and rear exchanged. */
Pose reversed(const Pose& pose)
{
  return pose * poseFromYpr(0, 0, 0, M_PI, 0, 0);
}

/** Covariance over the tangent of reversed(pose).
 * \param covariance over the tangent of the pose */
Matrix6 reversed(const Matrix6& covariance)
{
  Vector6 sign;
  sign << -1, -1, 1, -1, -1, 1;  // half a turn about z
  return sign.asDiagonal() * covariance * sign.asDiagonal();
}

/** Information of an observation. \param sigma_scale factor on its standard deviations */
Matrix6 informationOf(const Matrix6& covariance, double sigma_scale)
{
  return informationFromCovariance(covariance * sigma_scale * sigma_scale);
}

bool isReversed(const Pose& a, const Pose& b)
{
  return a.linear().col(0).dot(b.linear().col(0)) < 0;
}
}  // namespace

ObjectGraph::ObjectGraph(const ObjectGraphOptions& options, bool landmarks, FactorGraph& graph)
    : options_(options), landmarks_(landmarks), graph_(graph)
{
  validate(options_, "objects");
}

void ObjectGraph::add(const Frame& frame, const View& view)
{
  const Pose T_vehicle_odom = frame.T_odom_vehicle.inverse();
  for (const TrackedObject& tracked : frame.objects)
  {
    if (!tracked.observed)
    {
      continue;
    }
    const Pose T_vehicle_object = T_vehicle_odom * poseOf(tracked.observation);
    const Observation observation = observationOf(tracked, T_vehicle_object, frame, view);
    if (!observation.T_keyframe_object.matrix().allFinite() ||
        !observation.covariance.allFinite() ||  // which LLT does not report
        Eigen::LLT<Matrix6>(observation.covariance).info() != Eigen::Success)
    {
      ++unusable_;
      continue;
    }
    if (T_vehicle_object.translation().norm() > options_.max_range)
    {
      continue;
    }
    ObjectKey key(tracked.id, sighting_[tracked.id]);
    if (isStray(key, objects_[key], observation))
    {
      ++jumps_;
      if (++objects_[key].strays < stray_confirmations)
      {
        continue;
      }
      key.second = ++sighting_[tracked.id];
    }
    Object& object = objects_[key];
    object.strays = 0;
    object.landmark = landmarks_ && isVehicle(tracked.object_class);
    object.observations.push_back(observation);
    if (tracked.confirmed)
    {
      decide(key, object);
      insertNew(key, object);
    }
  }
  for (auto it = objects_.begin(); it != objects_.end();)
  {
    const bool forgotten = it->second.state == State::undecided &&
                           frame.time() - it->second.observations.back().time > forget_after;
    it = forgotten ? objects_.erase(it) : std::next(it);
  }
}

ObjectGraph::Observation ObjectGraph::observationOf(const TrackedObject& tracked,
                                                    const Pose& T_vehicle_object,
                                                    const Frame& frame,
                                                    const View& view) const
{
  Observation observation;
  observation.scan = frame.index;
  observation.stamp = frame.scan.stamp;
  observation.time = frame.time();
  observation.keyframe = view.keyframe;
  observation.T_keyframe_object = view.T_keyframe_vehicle * T_vehicle_object;
  observation.drift = view.drift;
  observation.drift_angle = view.drift_angle;
  const Matrix6 A = adjointSE3(T_vehicle_object.inverse());
  observation.covariance = tangentCovariance(tracked.observation_covariance,
                                             tracked.observation.yaw, options_.tilt_sigma) +
                           A * view.covariance * A.transpose();
  return observation;
}

void ObjectGraph::insertNew(const ObjectKey& key, Object& object)
{
  if (object.state == State::moving && graph_.contains(staticKey(key)))
  {
    removeFromGraph(key, object);
  }
  for (; object.state != State::undecided && object.in_graph < object.observations.size();
       ++object.in_graph)
  {
    if (object.state == State::stationary)
    {
      insertStanding(key, object, object.observations[object.in_graph]);
    }
    else
    {
      insertMoving(key, object, object.in_graph);
    }
  }
}

void ObjectGraph::removeFromGraph(const ObjectKey& key, Object& object)
{
  graph_.remove(staticKey(key));
  object.in_graph = 0;
  object.mean = {};
}

void ObjectGraph::insertStanding(const ObjectKey& object_key,
                                 Object& object,
                                 const Observation& observation)
{
  const Key key = staticKey(object_key);
  if (!graph_.contains(key))
  {
    graph_.addPose(key,
                   graph_.pose(Key::ego(observation.keyframe)) * observation.T_keyframe_object);
  }
  Pose T = observation.T_keyframe_object;
  Matrix6 covariance = observation.covariance;
  if (isReversed(graph_.pose(Key::ego(observation.keyframe)) * T, graph_.pose(key)))
  {
    T = reversed(T);
    covariance = reversed(covariance);
  }
  MeanObservation& mean = object.mean;
  if (mean.count == 0 || mean.keyframe != observation.keyframe)
  {
    mean = {};
    mean.keyframe = observation.keyframe;
  }
  else
  {
    graph_.removeFactor(mean.factor);
  }
  ++mean.count;
  const double share = 1 / static_cast<double>(mean.count);
  mean.T_keyframe_object =
      mean.count == 1 ? T : orthonormalised(interpolate(mean.T_keyframe_object, T, share));
  mean.covariance += share * (covariance - mean.covariance);
  mean.factor = graph_.add(std::make_unique<ObservationFactor>(
      mean.keyframe, key, mean.T_keyframe_object,
      informationOf(mean.covariance, options_.static_sigma_scale)));
}

void ObjectGraph::insertMoving(const ObjectKey& object_key, Object& object, std::size_t i)
{
  const int id = object_key.first;
  Observation& now = object.observations[i];
  const Pose T_map_keyframe = graph_.pose(Key::ego(now.keyframe));
  const Key key = Key::objectPose(id, now.scan);
  if (i > 0 && isReversed(graph_.pose(Key::objectPose(id, object.observations[i - 1].scan)),
                          T_map_keyframe * now.T_keyframe_object))
  {
    now.T_keyframe_object = reversed(now.T_keyframe_object);
    now.covariance = reversed(now.covariance);
  }
  graph_.addPose(key, T_map_keyframe * now.T_keyframe_object);
  graph_.add(std::make_unique<ObservationFactor>(
      now.keyframe, key, now.T_keyframe_object,
      informationOf(now.covariance, options_.moving_sigma_scale)));
  if (i > 0 && now.time - object.observations[i - 1].time <= options_.max_gap)
  {
    addMotionFactors(id, object.observations[i - 1], now);
  }
}

void ObjectGraph::addMotionFactors(int id, const Observation& before, const Observation& now)
{
  const double dt = now.time - before.time;
  const Key key_before = Key::objectVelocity(id, before.scan);
  const Vector6 motion = logSE3(graph_.pose(Key::objectPose(id, before.scan)).inverse() *
                                graph_.pose(Key::objectPose(id, now.scan)));
  const bool has_velocity = graph_.contains(key_before);
  const Vector6 expected = has_velocity ? Vector6(dt * graph_.vector(key_before)) : motion;
  if ((motion - expected).head<3>().norm() > options_.max_jump)
  {
    ++jumps_;
    return;
  }
  graph_.addVector(Key::objectVelocity(id, now.scan), motion / dt);
  graph_.add(std::make_unique<ObjectMotionFactor>(
      id, before.scan, now.scan, dt,
      informationFromSigmas(options_.motion_sigma * dt, options_.angular_motion_sigma * dt)));
  if (has_velocity)
  {
    graph_.add(std::make_unique<SmoothMotionFactor>(
        id, before.scan, now.scan,
        informationFromSigmas(options_.acceleration_sigma * dt,
                              options_.angular_acceleration_sigma * dt)));
  }
}

void ObjectGraph::appendWindow(double time, std::set<Key>& free) const
{
  for (const auto& [key, object] : objects_)
  {
    if (object.in_graph == 0 || time - object.observations.back().time > options_.window)
    {
      continue;
    }
    if (object.state == State::stationary)
    {
      free.insert(staticKey(key));
      continue;
    }
    std::size_t first = object.in_graph;
    while (first > 0 && time - object.observations[first - 1].time <= options_.window)
    {
      --first;
    }
    appendVariables(key.first, object, first, object.in_graph, free);
  }
}

void ObjectGraph::appendVariables(
    int id, const Object& object, std::size_t begin, std::size_t end, std::set<Key>& keys) const
{
  for (std::size_t i = begin; i < end; ++i)
  {
    const std::size_t scan = object.observations[i].scan;
    keys.insert(Key::objectPose(id, scan));
    if (graph_.contains(Key::objectVelocity(id, scan)))
    {
      keys.insert(Key::objectVelocity(id, scan));
    }
  }
}

void ObjectGraph::finish()
{
  for (auto& [key, object] : objects_)
  {
    if (object.state == State::stationary && !isStanding(object))
    {
      object.state = State::moving;
      insertNew(key, object);
    }
    if (object.state == State::stationary)
    {
      limitInformation(key);
    }
  }
}

/** Share of its information that each observation of a static object keeps: in total that of at
 * most `static_saturation` keyframes. */
double ObjectGraph::informationShare(std::size_t observations) const
{
  return std::min(1.0, options_.static_saturation / static_cast<double>(observations));
}

void ObjectGraph::limitInformation(const ObjectKey& key)
{
  const std::vector<FactorGraph::FactorId> factors = graph_.factorsOf(staticKey(key));
  const double share = informationShare(factors.size());
  if (share >= 1)
  {
    return;
  }
  for (const FactorGraph::FactorId id : factors)
  {
    const Factor& factor = graph_.factor(id);
    auto weaker = std::make_unique<ObservationFactor>(
        static_cast<std::size_t>(factor.keys()[0].index), factor.keys()[1], factor.measurement(),
        share * factor.information());
    graph_.removeFactor(id);
    graph_.add(std::move(weaker));
  }
}

std::size_t ObjectGraph::releaseContradicted(const FactorGraphOptions& options)
{
  std::size_t released = 0;
  for (auto& [key, object] : objects_)
  {
    if (object.state != State::stationary)
    {
      continue;
    }
    std::size_t outside = 0;
    const auto& factors = graph_.factorsOf(staticKey(key));
    // An observation does not fit better because there are many.
    const double limit = options.object_loss_width * std::sqrt(informationShare(factors.size()));
    for (const FactorGraph::FactorId factor : factors)
    {
      outside += graph_.whitenedResidual(factor) > limit ? 1 : 0;
    }
    if (2 * outside > factors.size())
    {
      object.state = State::moving;
      insertNew(key, object);
      ++released;
    }
  }
  return released;
}

std::vector<std::string> ObjectGraph::warnings() const
{
  std::vector<std::string> result;
  if (unusable_ > 0)
  {
    result.push_back(counted(unusable_, "observation") +
                     " of objects left out of the graph: no finite position or covariance");
  }
  if (jumps_ > 0)
  {
    result.push_back(
        counted(jumps_, "observation") +
        formatted(" of objects not linked with earlier ones: more than %g m from the expected "
                  "place (objects.max_jump)",
                  options_.max_jump));
  }
  return result;
}

void ObjectGraph::exchangeState(StateArchive& archive)
{
  archive(objects_, sighting_, unusable_, jumps_);
}
}  // namespace dyslam
