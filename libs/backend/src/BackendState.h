// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Backend.h>
#include <dyslam/base/Error.h>

#include <cstddef>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "GnssAnchor.h"
#include "GravityAnchor.h"
#include "OdometryChain.h"
#include "loops/LoopCorrection.h"
#include "objects/FrameInKeyframe.h"
#include "objects/ObjectGraph.h"
#include "prior_map/LocalisedStretches.h"
#include "prior_map/MapLocaliser.h"

namespace dyslam
{
struct Backend::State
{
  State(const BackendConfig& config,
        KeyframeStore& store,
        const std::vector<Eigen::Vector3f>& prior_map)
      : options(config.backend),
        solver(config.solver),
        window_keyframes(static_cast<std::size_t>(config.objects.window_keyframes)),
        keyframes(store),
        odometry(config.backend),
        closer(config.loops, store),
        correction(config.backend, config.solver, graph),
        objects(config.objects, config.backend.mode == BackendMode::full, graph),
        gnss(config.gnss),
        gravity_anchor(config.gravity),
        localiser(config.prior_map, prior_map, store),
        stretches(store, graph)
  {
    validate(options, "backend");
    validate(solver, "solver");
    validate(gnss.options(), "gnss");
    validate(gravity_anchor.options(), "gravity");
    if (localiser.hasMap() && options.mode == BackendMode::odometry)
    {
      throw UserError(
          "prior_map.file: backend.mode=odometry has no factors but the odometry; set another "
          "backend.mode");
    }
    if (!keyframes.empty())
    {
      throw std::invalid_argument("Backend: the store has keyframes already");
    }
  }

  [[nodiscard]] bool hasObjects() const { return options.hasObjects(); }
  void addKeyframe(const Frame& frame);
  /** \return number of loops added to the graph */
  std::size_t insertLoops(const std::vector<Loop>& decided);
  /** Registers the newest keyframe to the prior map, if there is one. */
  void localise();
  /** Moves all poses of the graph to another frame of the map. */
  void moveMap(const Pose& T_new_old);
  /** Variables of objects that are optimised with the newest keyframes. */
  [[nodiscard]] std::set<Key> objectsOf(const Frame& frame) const;
  bool optimiseWindow(const Frame& frame);
  void optimiseForLoops(const Frame& frame);
  void optimiseAll();
  /** Copies the poses of keyframes from number `first` on from the graph. */
  void correctKeyframes(std::size_t first);
  /** T_map_odom by the present pose of the newest keyframe. */
  [[nodiscard]] Pose mapFromOdometry() const
  {
    return keyframes.back().T_map_vehicle * odometry.keyframePose().inverse();
  }

  // BackendAnchors.cpp
  /** FrameInKeyframe::time of a stamp that came with a frame [s]. */
  [[nodiscard]] double timeOf(double stamp, const Frame& frame) const;
  /** Keeps the accelerations of a frame. \param T_previous_vehicle motion since the frame before */
  void addAccelerations(const Frame& frame, const Pose& T_previous_vehicle);
  /** Keeps the satellite positions of a frame, with times as those of `frames`. */
  void addPositions(const Frame& frame);
  /** What an optimisation of the whole graph changes. */
  struct Solved
  {
    FactorGraph::Solution values;
    OptimisationResult result;
  };
  [[nodiscard]] Solved solved() const { return {graph.solution(), correction.last()}; }
  void restore(const Solved& before);
  /** Pose of the vehicle at a FrameInKeyframe::time [s]; nothing if no scan is near. */
  [[nodiscard]] std::optional<VehicleInKeyframe> vehicleAt(double time) const;
  /** Finds the vertical by the accelerations of an IMU. */
  void tieToVertical();
  /** Rotates all poses of the graph to the vertical. */
  void levelMap(const Pose& T_level_map);
  /** Georeferences the map by the positions of a satellite receiver. */
  void tieToEarth();
  /** Warns if the vertical of the georeference contradicts the accelerations. */
  void compareVerticals();

  BackendOptions options;
  FactorGraphOptions solver;
  std::size_t window_keyframes;
  KeyframeStore& keyframes;
  OdometryChain odometry;
  LoopCloser closer;
  FactorGraph graph;
  LoopCorrection correction;
  ObjectGraph objects;
  GnssAnchor gnss;
  std::optional<Georeference> georeference;
  GravityAnchor gravity_anchor;
  std::optional<Gravity> gravity;
  MapLocaliser localiser;
  LocalisedStretches stretches;
  bool is_localised_now = false;  //!< since the last optimisation
  std::vector<FrameInKeyframe> frames;
  std::vector<Loop> loops;
  std::vector<std::string> problems;  //!< factors that the graph rejected
};
}  // namespace dyslam
