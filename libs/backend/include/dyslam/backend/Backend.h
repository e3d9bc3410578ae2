// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/GnssOptions.h>
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/backend/ObjectGraphOptions.h>
#include <dyslam/backend/PoseGraph.h>
#include <dyslam/backend/SmoothedObject.h>
#include <dyslam/core/Angle.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Georeference.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Trajectory.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** What the graph holds; the paper's ablation (Table 6). */
enum class BackendMode
{
  odometry,  //!< the chain of odometry factors: nothing to optimise
  ego,       //!< odometry and loops (DyLO-SAM)
  segmot,    //!< and every object as a moving one, as in LIO-SEGMOT
  full,      //!< and objects, static ones as landmarks, moving ones with velocities (DyLO-SAM-MOT)
};

struct BackendOptions : Options
{
  BackendMode mode = BackendMode::ego;
  double keyframe_distance = 1.5;  //!< translation after which a keyframe is added [m]
  /** Rotation after which a keyframe is added [rad]. */
  double keyframe_angle = 10 * radians_per_degree;
  double unconverged_sigma = 0.1;  //!< sigma of a step without convergence [m]
  /** Sigma of a step without convergence [rad]. */
  double unconverged_sigma_rotation = 0.286 * radians_per_degree;
  /** Whitened residual of a new loop above which the graph is optimised. */
  double residual_to_optimise = 3;
  int loops_to_optimise = 20;  //!< number of new loops after which it is optimised
  /** Newest keyframes optimised for a loop consistent with odometry and earlier loops; 0: all. */
  int correction_keyframes = 100;
  /** Growth of the graph, as a fraction, after which a loop optimises all keyframes again. */
  double correction_growth = 0.1;

  void describe(OptionsVisitor& visitor) override;
};

/** All options of the backend. */
struct BackendConfig
{
  BackendOptions backend;
  LoopCloserOptions loops;
  ObjectGraphOptions objects;
  FactorGraphOptions solver;
  GnssOptions gnss;
};

/** Keyframes, odometry, loops and objects in one factor graph, and its optimisation (paper,
 * section 3.3.2).
 *
 * A frame costs a bounded time on average: the newest keyframes and objects are optimised, older
 * ones are held fixed. Everything is optimised together after a loop that does not fit otherwise,
 * whenever the graph has grown by a tenth, and at the end. Deterministic; not thread-safe.
 */
class Backend
{
 public:
  /** \param keyframes empty; outlives the backend, which adds the keyframes and corrects their
   * poses: a keyframe's number is its ego pose in the graph. */
  Backend(const BackendConfig& config, KeyframeStore& keyframes);
  ~Backend();
  Backend(Backend&&) noexcept;
  Backend& operator=(Backend&&) noexcept;

  /** Reads scan.stamp, cloud, moving, motion, T_odom_vehicle, objects and gnss; fills is_keyframe
   * and T_map_odom. Frames come in order of time. The same as the three steps below. */
  void addFrame(Frame& frame);

  /** The steps of addFrame(), for callers that do something in between: every frame, in this order.
   * Accumulates the odometry; adds keyframe, odometry factor and objects. Fills is_keyframe, and
   * T_map_odom by the present estimate. \return is_keyframe */
  bool addOdometry(Frame& frame);
  /** Looks for loops from the frame, if it is a keyframe, and adds those accepted now; moves no
   * pose. Keyframes whose motion did not converge make none. Without this call no loop is found.
   * \return number of loops added */
  std::size_t addLoops(const Frame& frame);
  /** Optimises what is due: the newest part, or everything where a loop requires it. Fills
   * T_map_odom. \return true if the pose of a keyframe changed */
  bool optimise(Frame& frame);

  /** Decides the pending loops and objects, ties the map to the earth where there are positions of
   * a satellite receiver, and optimises everything once more (call it after the last frame). */
  void finish();

  [[nodiscard]] const FactorGraph& factorGraph() const;
  /** What is kept from frame to frame; the keyframes are saved by themselves. */
  void exchangeState(StateArchive& archive);
  /** View of the ego poses, odometry and loops in use as MRPT has them; built for the caller. */
  [[nodiscard]] PoseGraph graph() const;
  [[nodiscard]] const KeyframeStore& keyframes() const;
  /** Every frame's T_map_vehicle by the present estimate. */
  [[nodiscard]] Trajectory optimizedTrajectory() const;
  /** All candidates that were decided, in order. Of the accepted ones, factorGraph().usedLoops()
   * are those that the rest of the graph does not contradict. */
  [[nodiscard]] const std::vector<Loop>& loops() const;
  /** Every object of the graph at every scan that observed it, by scan, then id. */
  [[nodiscard]] std::vector<SmoothedObject> smoothedObjects() const;
  /** Where the map is on the earth, after finish(); nothing without positions that show it. */
  [[nodiscard]] const std::optional<Georeference>& georeference() const;
  /** Of the last optimisation of everything; default before the first. */
  [[nodiscard]] const OptimisationResult& lastOptimisation() const;
  /** Warnings about data that the graph could not use. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
