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

/** Puts the observations of tracked objects into a factor graph.
 *
 * An object is kept back until it is clear whether it stands or moves. One that stands is one
 * variable for its whole sighting, observed once per keyframe; one that moves has a pose at every
 * scan it was observed in and a velocity in between. An object that moved at any time is one that
 * moves: a mover taken for a landmark would bend the ego-motion, a landmark taken for a mover costs
 * its gain alone.
 */
class ObjectGraph
{
 public:
  /** \param landmarks false: objects that stand are treated like those that move
   *  \param graph outlives this; its ego poses are there before they are referred to */
  ObjectGraph(const ObjectGraphOptions& options, bool landmarks, FactorGraph& graph);

  /** Where a frame is seen from. */
  struct View
  {
    std::size_t keyframe = 0;  //!< the newest one
    Pose T_keyframe_vehicle = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();  //!< of it, over its tangent
    /** Variances of the odometry per axis, summed since the start: how far it may have drifted
     * between two views [m^2], [rad^2]. */
    double drift = 0;
    double drift_angle = 0;
  };
  /** Takes the observations of the frame's confirmed objects. */
  void add(const Frame& frame, const View& view);

  /** The objects' variables to be optimised with the newest scans. */
  void appendWindow(double time, std::set<Key>& free) const;

  /** Decides about all objects with what is known at the end. */
  void finish();
  /** Turns objects that stand, but do not fit their observations by the present values, into moving
   * ones. \return how many */
  std::size_t releaseContradicted(const FactorGraphOptions& options);

  /** Every object at every scan it was observed in, by scan, then id. */
  [[nodiscard]] std::vector<SmoothedObject> smoothed() const;
  /** Observations that were left out, in words. */
  [[nodiscard]] std::vector<std::string> warnings() const;

  /** What is kept of the objects; the graph is saved by itself. */
  void exchangeState(StateArchive& archive);

 private:
  enum class State
  {
    undecided,
    standing,
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
  /** Observations of a standing object from one keyframe, as one. */
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
    bool landmark = false;  //!< of a kind that may serve as one
    State state = State::undecided;
    std::vector<Observation> observations;
    std::size_t in_graph = 0;  //!< of them
    MeanObservation mean;      //!< of a standing object, from the newest keyframe
    std::size_t fast = 0;      //!< successive observations that show it moving
    std::size_t away = 0;      //!< successive observations off where it stands
    std::size_t strays = 0;    //!< successive observations far from where it stands
  };
  /** Id and number of the sighting: a track may jump from one parked car to the next. */
  using ObjectKey = std::pair<int, int>;

  [[nodiscard]] bool isStray(const ObjectKey& key,
                             const Object& object,
                             const Observation& observation) const;
  void decide(const ObjectKey& key, Object& object) const;
  [[nodiscard]] static Key standingKey(const ObjectKey& key)
  {
    return Key::staticObject(key.first, key.second);
  }
  [[nodiscard]] std::vector<PlanarObservation> recent(const Object& object, double duration) const;
  [[nodiscard]] bool stands(const Object& object) const;
  [[nodiscard]] double standingLimit(const Object& object) const;
  void limitInformation(const ObjectKey& key);
  void insertNew(const ObjectKey& key, Object& object);
  void insertStanding(const ObjectKey& key, Object& object, const Observation& observation);
  void insertMoving(const ObjectKey& key, Object& object, std::size_t i);
  void joinMotion(int id, const Observation& before, const Observation& now);
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
