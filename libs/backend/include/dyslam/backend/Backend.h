// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/backend/PoseGraph.h>
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/core/Frame.h>
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
  double keyframe_distance = 1.5;            //!< a new keyframe after this way [m] ...
  double keyframe_angle = 0.17453292519943;  //!< ... or this turn [rad]
  double odometry_sigma_translation = 0.01;  //!< added to each step's own uncertainty [m]
  double odometry_sigma_rotation = 0.0005;   //!< [rad]
  double unconverged_factor = 10;            //!< on both where the odometry did not converge
  double misfit_to_optimise = 3;  //!< optimise when a new loop is off by this [std. deviations] ...
  int loops_to_optimise = 20;     //!< ... or this many loops have come

  void describe(OptionsVisitor& visitor) override;
};

/** The solver's options with the backend's defaults: from the present estimate, in the paper's
 * coordinates, wrong loops switched off. */
struct BackendSolverOptions : PoseGraphSolverOptions
{
  BackendSolverOptions();
};

/** What one keyframe is in the graph: node `id` of PoseGraph has the same number. */
struct KeyframePose
{
  std::size_t id = 0;
  std::size_t frame = 0;  //!< Frame::index
  double stamp = 0;       //!< UNIX time [s]
  Pose T_map_vehicle = Pose::Identity();
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
  Backend(const BackendOptions& options,
          const LoopCloserOptions& loops,
          const BackendSolverOptions& solver);
  ~Backend();
  Backend(Backend&&) noexcept;
  Backend& operator=(Backend&&) noexcept;

  /** Reads scan.stamp, cloud, moving, motion and T_odom_vehicle; fills is_keyframe and
   * T_map_odom. Frames come in order of time. */
  void addFrame(Frame& frame);

  /** Decides the loops still open and optimises once more (call it after the last frame). */
  void finish();

  [[nodiscard]] const PoseGraph& graph() const;
  [[nodiscard]] std::vector<KeyframePose> keyframes() const;
  /** Number of optimisations so far: exports re-stitch when it changed. */
  [[nodiscard]] std::size_t revision() const;
  /** Every frame's T_map_vehicle by the present estimate. */
  [[nodiscard]] Trajectory optimizedTrajectory() const;
  /** All candidates that were looked at, in order. */
  [[nodiscard]] const std::vector<Loop>& loops() const;
  /** Of the last optimisation; default before the first. */
  [[nodiscard]] const PoseGraphResult& lastOptimisation() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
