// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/ObjectGraphOptions.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/SmoothedObject.h>

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
 * An object is not added until it is decided whether it is static or moving. A static object is one
 * variable for its whole sighting, observed once per keyframe; a moving object has a pose at every
 * scan that observed it and velocities in between. An object that ever moved is moving: used as a
 * landmark it would bias the ego-motion, whereas a static object treated as moving only adds no
 * information.
 */
class ObjectGraph
{
 public:
  /** \param landmarks false: static objects are treated as moving \param graph outlives this; has
   *  the ego poses before observations from them are added */
  ObjectGraph(const ObjectGraphOptions& options, bool landmarks, FactorGraph& graph);

  /** Vehicle pose of a frame relative to the newest keyframe. */
  struct View
  {
    std::size_t keyframe = 0;  //!< number of the newest keyframe
    Pose T_keyframe_vehicle = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();  //!< covariance over T_keyframe_vehicle's tangent
    /** Variances of the odometry per axis, accumulated since the start [m^2], [rad^2]: their
     * difference is the drift between two views. */
    double drift = 0;
    double drift_angle = 0;
  };
  /** Adds the observations of the frame's objects; observations of an object that is not confirmed
   * or not decided yet are kept until it is. */
  void add(const Frame& frame, const View& view);

  /** Variables of objects that are optimised with the newest scans. */
  void appendWindow(double time, std::set<Key>& free) const;

  /** Decides all remaining objects at the end. */
  void finish();
  /** Turns static objects into moving ones if most of their observations do not fit at the present
   * values: their residuals are above `object_loss_width`, whitened without the limit of
   * `static_saturation`. To be called after finish(). \return the number of these objects */
  std::size_t releaseContradicted(const FactorGraphOptions& options);

  /** Every object at every scan that observed it, ordered by scan, then id. */
  [[nodiscard]] std::vector<SmoothedObject> smoothed() const;
  /** Warnings about observations that were left out. */
  [[nodiscard]] std::vector<std::string> warnings() const;

  /** Saves or loads the state of the objects; the graph is saved separately. */
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
    double drift = 0;                          //!< View::drift of its scan
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
    bool landmark = false;  //!< its class may be a landmark
    State state = State::undecided;
    std::vector<Observation> observations;
    std::size_t in_graph = 0;  //!< number of observations in the graph
    MeanObservation mean;      //!< static object: mean observation from the newest keyframe
    std::size_t fast = 0;      //!< number of successive observations that show it moving
    std::size_t away = 0;      //!< number of successive observations displaced from its position
    std::size_t strays = 0;    //!< number of successive observations far from its position
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
  /** The observations of the last `duration` seconds, the newest first; older ones, too, up to
   * `least`, as long as they are of successive scans. */
  [[nodiscard]] std::vector<PlanarObservation> recent(const Object& object,
                                                      double duration,
                                                      std::size_t least = 0) const;
  /** Whether the whole sighting shows the object at rest. */
  [[nodiscard]] bool isStanding(const Object& object) const;
  [[nodiscard]] double staticLimit(const Object& object) const;
  [[nodiscard]] double informationShare(std::size_t observations) const;
  void limitInformation(const ObjectKey& key);
  /** Adds the observations that are not in the graph yet, if the object is decided. */
  void insertNew(const ObjectKey& key, Object& object);
  void insertStanding(const ObjectKey& key, Object& object, const Observation& observation);
  void insertMoving(const ObjectKey& key, Object& object, std::size_t i);
  /** Adds the velocity between two successive observations with its motion factors, unless the
   * object jumped. */
  void addMotionFactors(int id, const Observation& before, const Observation& now);
  void removeFromGraph(const ObjectKey& key, Object& object);
  /** Appends the poses and velocities of a moving object at its observations [begin, end), which
   * are in the graph. */
  void appendVariables(
      int id, const Object& object, std::size_t begin, std::size_t end, std::set<Key>& keys) const;
  [[nodiscard]] std::vector<Key> velocitiesAt(int id, const Object& object, std::size_t i) const;
  void fillCovariances(const std::set<Key>& free, std::map<Key, Matrix6>& covariances) const;
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
  std::map<int, int> sighting_;  //!< number of the newest sighting of each id
  std::size_t unusable_ = 0;     //!< number of observations that were left out
  std::size_t jumps_ = 0;        //!< number of observations beyond max_jump
};
}  // namespace dyslam
