// SPDX-License-Identifier: BSD-3-Clause
#include "DyloOptions.h"

namespace dyslam
{
void DyloOptions::describe(OptionsVisitor& v)
{
  v.text("weights", weights, "file, or name of weights shipped with DySLAM");
  v.choice("start", start,
           {{"standing", DyloStart::standing}, {"prediction", DyloStart::prediction}},
           "initial guess: zero motion or the predicted one");
  v.integer("threads", threads, 1, 64, "of the network");
  v.flag("prior", prior, "fuse the predicted motion as a prior");
  v.flag("deskew", deskew, "deskew by the estimated motion, not only by the predicted one");
  v.flag("confidence", confidence, "output the static confidence of each point");
  v.real("points_per_measurement", points_per_measurement, 1, 1e6,
         "correlated points that count as one measurement");
  v.real("min_inlier_share", min_inlier_share, 0, 1,
         "the match has failed below this share of inliers");
  v.real("max_last_step", max_last_step, 1e-6, 100,
         "the match has failed if the last step is larger [m]");
  v.real("max_translation", max_translation, 0.01, 100, "between two scans [m]");
  v.degrees("max_rotation_deg", max_rotation, 0.1, 180, "between two scans");
}
}  // namespace dyslam
