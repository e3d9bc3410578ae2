// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/backend/PoseGraph.h>
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace dyslam
{
/** What the graph holds. */
enum class BackendMode
{
  odometry,  //!< the chain of odometry edges: nothing to optimise
  ego,       //!< odometry and loops
};

struct BackendOptions : Options
{
  BackendMode mode = BackendMode::ego;
  double keyframe_distance = 1.5;            //!< a new keyframe after this distance [m] ...
  double keyframe_angle = 0.17453292519943;  //!< ... or this turn [rad]
  double odometry_sigma_translation = 0.01;  //!< added to each step's own uncertainty [m]
  double odometry_sigma_rotation = 0.0005;   //!< [rad]
  double unconverged_sigma_scale = 10;       //!< of both where the odometry did not converge
  /** Optimise when a new loop's residual is this large [standard deviations] ... */
  double residual_to_optimise = 3;
  int loops_to_optimise = 20;  //!< ... or this many loops have come

  void describe(OptionsVisitor& visitor) override;
};

/** The solver's options with the backend's defaults: from the present estimate, in the paper's
 * coordinates, wrong loops switched off. */
struct BackendSolverOptions : PoseGraphSolverOptions
{
  BackendSolverOptions();
};

/** Keyframes, odometry edges, loops and their optimisation for the pipeline.
 *
 * Between loops a frame costs a bounded time. The number of the solver's threads changes results by
 * rounding alone.
 * Not thread-safe.
 */
class Backend
{
 public:
  /** \param keyframes empty; outlives the backend, which adds the keyframes and corrects their
   * poses: a keyframe's number is its node in the graph. */
  Backend(const BackendOptions& options,
          const LoopCloserOptions& loops,
          const BackendSolverOptions& solver,
          KeyframeStore& keyframes);
  ~Backend();
  Backend(Backend&&) noexcept;
  Backend& operator=(Backend&&) noexcept;

  /** Reads scan.stamp, cloud, moving, motion and T_odom_vehicle; fills is_keyframe and
   * T_map_odom. Frames come in order of time. */
  void addFrame(Frame& frame);

  /** Decides the loops still open and optimises once more (call it after the last frame). */
  void finish();

  /** Keyframes at their present poses, odometry edges and accepted loops; built for the caller. */
  [[nodiscard]] PoseGraph graph() const;
  [[nodiscard]] const KeyframeStore& keyframes() const;
  /** Every frame's T_map_vehicle by the present estimate. */
  [[nodiscard]] Trajectory optimizedTrajectory() const;
  /** All candidates that were decided, in order. */
  [[nodiscard]] const std::vector<Loop>& loops() const;
  /** Of the last optimisation; default before the first. */
  [[nodiscard]] const PoseGraphResult& lastOptimisation() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
