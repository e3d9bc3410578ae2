// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/ObjectGraphOptions.h>
#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Frame.h>

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ObjectMotionEvidence.h"

namespace dyslam
{
class StateArchive;

/** Adds the observations of tracked objects to a factor graph.
 *
 * An object is held back until it is decided whether it is static or moving. A static one is one
 * variable for its whole sighting, observed once per keyframe; a moving one has a pose at every
 * scan it was observed in and a velocity in between. An object that moved at any time is moving: a
 * moving object used as a landmark would bias the ego-motion, a landmark treated as moving only
 * loses its information.
 */
class ObjectGraph
{
 public:
  /** \param landmarks false: static objects are treated like moving ones \param graph outlives
   *  this; its ego poses are there before they are referred to */
  ObjectGraph(const ObjectGraphOptions& options, bool landmarks, FactorGraph& graph);

  /** The ego pose that a frame is observed from. */
  struct View
  {
    std::size_t keyframe = 0;  //!< the newest one
    Pose T_keyframe_vehicle = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();  //!< of it, over its tangent
    /** Variances of the odometry per axis, summed since the start: the drift between two views
     * [m^2], [rad^2]. */
    double drift = 0;
    double drift_angle = 0;
  };
  /** Adds the observations of the frame's objects; those of an object that is not confirmed or not
   * decided yet are kept until it is. */
  void add(const Frame& frame, const View& view);

  /** The objects' variables to be optimised with the newest scans. */
  void appendWindow(double time, std::set<Key>& free) const;

  /** Decides all remaining objects at the end. */
  void finish();
  /** Turns static objects that do not fit their observations at the present values into moving
   * ones. \return their number */
  std::size_t releaseContradicted(const FactorGraphOptions& options);

  /** Every object at every scan it was observed in, by scan, then id. */
  [[nodiscard]] std::vector<SmoothedObject> smoothed() const;
  /** Warnings about observations that were left out. */
  [[nodiscard]] std::vector<std::string> warnings() const;

  /** What is kept of the objects; the graph is saved by itself. */
  void exchangeState(StateArchive& archive);

 private:
  enum class State
  {
    undecided,
    stationary,
    moving,
  };
  struct Observation
  {
    std::size_t scan = 0;
    double stamp = 0;
    double time = 0;  //!< Frame::time()
    std::size_t keyframe = 0;
    Pose T_keyframe_object = Pose::Identity();
    Matrix6 covariance = Matrix6::Identity();  //!< over the tangent of T_keyframe_object
    double drift = 0;                          //!< of its view
    double drift_angle = 0;
  };
  /** Mean of the observations of a static object from one keyframe. */
  struct MeanObservation
  {
    std::size_t keyframe = 0;
    std::size_t count = 0;
    Pose T_keyframe_object = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    FactorGraph::FactorId factor = 0;
  };
  struct Object
  {
    bool landmark = false;  //!< of a class that may be one
    State state = State::undecided;
    std::vector<Observation> observations;
    std::size_t in_graph = 0;  //!< of them
    MeanObservation mean;      //!< of a static object, from the newest keyframe
    std::size_t fast = 0;      //!< successive observations that show it moving
    std::size_t away = 0;      //!< successive observations displaced from its position
    std::size_t strays = 0;    //!< successive observations far from its position
  };
  /** Id and number of the sighting: a track may jump from one parked car to the next. */
  using ObjectKey = std::pair<int, int>;

  [[nodiscard]] Observation observationOf(const TrackedObject& tracked,
                                          const Pose& T_vehicle_object,
                                          const Frame& frame,
                                          const View& view) const;
  /** Whether a static object is observed far from its position. */
  [[nodiscard]] bool isStray(const ObjectKey& key,
                             const Object& object,
                             const Observation& observation) const;
  /** Decides from the observations so far whether the object is static or moving. */
  void decide(const ObjectKey& key, Object& object) const;
  [[nodiscard]] static Key staticKey(const ObjectKey& key)
  {
    return Key::staticObject(key.first, key.second);
  }
  /** The observations of the last `duration` seconds, the newest first. */
  [[nodiscard]] std::vector<PlanarObservation> recent(const Object& object, double duration) const;
  /** Whether the whole sighting shows the object at rest. */
  [[nodiscard]] bool isStanding(const Object& object) const;
  [[nodiscard]] double staticLimit(const Object& object) const;
  void limitInformation(const ObjectKey& key);
  /** Adds the observations that are not in the graph yet, if the object is decided. */
  void insertNew(const ObjectKey& key, Object& object);
  void insertStanding(const ObjectKey& key, Object& object, const Observation& observation);
  void insertMoving(const ObjectKey& key, Object& object, std::size_t i);
  /** Adds the velocity between two successive observations with its motion factors, unless the
   * object jumped. */
  void addMotionFactors(int id, const Observation& before, const Observation& now);
  void removeFromGraph(const ObjectKey& key, Object& object);
  [[nodiscard]] Matrix6 informationOf(const Matrix6& covariance, double sigma_scale) const;
  void appendSmoothed(const ObjectKey& key,
                      const Object& object,
                      std::vector<SmoothedObject>& result) const;
  void addCovariances(const ObjectKey& key,
                      const Object& object,
                      std::vector<SmoothedObject>& result) const;

  ObjectGraphOptions options_;
  bool landmarks_;
  FactorGraph& graph_;
  std::map<ObjectKey, Object> objects_;
  std::map<int, int> sighting_;  //!< the newest one's of each id
  std::size_t unusable_ = 0;     //!< observations
  std::size_t jumps_ = 0;
};
}  // namespace dyslam
