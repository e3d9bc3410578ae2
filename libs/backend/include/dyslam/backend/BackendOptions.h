// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>

namespace dyslam
{
/** Factors that the graph contains; the paper's ablation (Table 6). */
enum class BackendMode
{
  odometry,  //!< the chain of odometry factors: nothing to optimise
  ego,       //!< odometry and loops (DyLO-SAM)
  segmot,    //!< odometry, loops, and every object as moving, as in LIO-SEGMOT
  full,      //!< odometry, loops, static objects as landmarks, moving objects (DyLO-SAM-MOT)
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
  int loops_to_optimise = 20;  //!< number of new loops after which the graph is optimised
  /** Newest keyframes optimised for a loop that fits odometry and earlier loops; 0: all. */
  int correction_keyframes = 100;
  /** Growth of the graph, as a fraction, after which a loop optimises all keyframes again. */
  double correction_growth = 0.1;

  /** Whether objects are in the graph. */
  [[nodiscard]] bool hasObjects() const
  {
    return mode == BackendMode::segmot || mode == BackendMode::full;
  }

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
