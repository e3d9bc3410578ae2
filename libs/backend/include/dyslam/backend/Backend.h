// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/BackendOptions.h>
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/GnssOptions.h>
#include <dyslam/backend/GravityOptions.h>
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/backend/ObjectGraphOptions.h>
#include <dyslam/backend/PoseGraph.h>
#include <dyslam/backend/PriorMapOptions.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Georeference.h>
#include <dyslam/core/Gravity.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/PriorMapFit.h>
#include <dyslam/core/SmoothedObject.h>
#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** All options of the backend. */
struct BackendConfig
{
  BackendOptions backend;
  LoopCloserOptions loops;
  ObjectGraphOptions objects;
  FactorGraphOptions solver;
  GnssOptions gnss;
  GravityOptions gravity;
  PriorMapOptions prior_map;

  /** Loads [backend], [loop], [objects], [solver], [gnss], [gravity] and [prior_map]. \throws
   * UserError for bad options. */
  [[nodiscard]] static BackendConfig load(ConfigLoader& config);
};

/** Keyframes, odometry, loops and objects in one factor graph, and its optimisation (paper,
 * section 3.3.2).
 *
 * A frame costs a bounded time on average: the newest keyframes and objects are optimised, older
 * ones are held fixed. Everything is optimised together after a loop that does not fit otherwise,
 * after any loop once the graph has grown by a tenth, and at the end. Deterministic; not
 * thread-safe.
 */
class Backend
{
 public:
  /** \param keyframes empty; outlives the backend, which adds the keyframes and corrects their
   * poses: a keyframe's number is its ego pose in the graph.
   * \param prior_map points of a static map in which the run is localised, its frame [m]; its file
   * is not read here. Once localised, all poses are in the frame of this map
   * \throws UserError for options that are out of range or contradict each other. */
  Backend(const BackendConfig& config,
          KeyframeStore& keyframes,
          const std::vector<Eigen::Vector3f>& prior_map = {});
  ~Backend();
  Backend(Backend&&) noexcept;
  Backend& operator=(Backend&&) noexcept;

  /** Adds a frame; frames come in order of Frame::time(), while their stamps may go back. Reads
   * scan.stamp, clock_offset, dt, cloud, moving, motion, T_odom_vehicle, objects, imu and gnss;
   * sets is_keyframe and T_map_odom. Equivalent to addOdometry(), addLoops() and optimise(). */
  void addFrame(Frame& frame);

  /** First step of addFrame(), for callers that do something between the steps: accumulates the
   * odometry; adds keyframe, odometry factor and objects. Sets is_keyframe, and T_map_odom by the
   * present estimate. \return is_keyframe */
  bool addOdometry(Frame& frame);
  /** Second step of addFrame(): searches for loops from the frame, if it is a keyframe and was
   * registered, and adds the accepted ones to the graph; changes no pose. With a prior map it also
   * registers the keyframe to this; the first registrations that localise the run move all poses,
   * those that find a lost run again are to be followed by optimise().
   * \return number of loops added */
  std::size_t addLoops(const Frame& frame);
  /** Third step of addFrame(): optimises the newest part of the graph, or all of it if a loop
   * requires it. Sets T_map_odom. \return true if the pose of a keyframe changed */
  bool optimise(Frame& frame);

  /** To be called after the last frame: decides the pending loops and objects, finds the vertical
   * if there are accelerations of an IMU, georeferences the map if there are positions of a
   * satellite receiver, and optimises everything once more. */
  void finish();

  [[nodiscard]] const FactorGraph& factorGraph() const;
  /** Saves or loads the state between frames; the KeyframeStore is saved separately. */
  void exchangeState(StateArchive& archive);
  /** Pose graph of MRPT with ego poses, odometry and loops in use; built at each call. */
  [[nodiscard]] PoseGraph graph() const;
  [[nodiscard]] const KeyframeStore& keyframes() const;
  /** T_map_vehicle of every frame by the present estimate. */
  [[nodiscard]] Trajectory optimisedTrajectory() const;
  /** All loop candidates that were decided, in order. factorGraph().usedLoops() has the accepted
   * ones that the rest of the graph does not contradict. */
  [[nodiscard]] const std::vector<Loop>& loops() const;
  /** Objects of the graph at every scan that observed them, ordered by scan, then id. */
  [[nodiscard]] std::vector<SmoothedObject> smoothedObjects() const;
  /** Pose of the map on the earth, after finish(); nothing if satellite positions don't show it. */
  [[nodiscard]] const std::optional<Georeference>& georeference() const;
  /** The vertical in the map frame, after finish(); nothing if no accelerations show it. */
  [[nodiscard]] const std::optional<Gravity>& gravity() const;
  /** How the run fits the prior map; nothing without one. */
  [[nodiscard]] std::optional<PriorMapFit> priorMapFit() const;
  /** Result of the last optimisation of the whole graph; default before the first. */
  [[nodiscard]] const OptimisationResult& lastOptimisation() const;
  /** Warnings about data that the backend could not use. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
