// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/BackendOptions.h>

namespace dyslam
{
void BackendOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "mode", mode,
      {{"odometry", BackendMode::odometry},
       {"ego", BackendMode::ego},
       {"segmot", BackendMode::segmot},
       {"full", BackendMode::full}},
      "factors of the graph: odometry; ego: also loops; segmot: also objects, all as moving; "
      "full: also objects, static ones as landmarks");
  visitor.real("keyframe_distance", keyframe_distance, 0, 1000,
               "translation since the last keyframe after which a new one is added [m]");
  visitor.degrees("keyframe_angle_deg", keyframe_angle, 0, 180,
                  "rotation since the last keyframe after which a new one is added [deg]");
  visitor.real("unconverged_sigma", unconverged_sigma, 1e-6, 100,
               "sigma of the translation of a step for which the odometry did not converge [m]");
  visitor.degrees("unconverged_sigma_rotation_deg", unconverged_sigma_rotation, 1e-5, 180,
                  "sigma of the rotation of a step for which the odometry did not converge [deg]");
  visitor.renamed("unconverged_sigma_translation", "unconverged_sigma");
  visitor.real("residual_to_optimise", residual_to_optimise, 0, 1e6,
               "whitened residual of a new loop above which the graph is optimised [sigmas]");
  visitor.integer("loops_to_optimise", loops_to_optimise, 1, 100000,
                  "number of new loops after which the graph is optimised");
  visitor.integer(
      "correction_keyframes", correction_keyframes, 0, 1000000,
      "newest keyframes optimised for a loop that is consistent with odometry and earlier loops; "
      "0: all");
  visitor.real("correction_growth", correction_growth, 0, 10,
               "growth of the number of keyframes after which a loop optimises all of them again, "
               "as a fraction");
}
}  // namespace dyslam
