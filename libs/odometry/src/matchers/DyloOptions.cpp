// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/Dylo.h>

namespace dyslam
{
void DyloOptions::describe(OptionsVisitor& v)
{
  v.text("weights", weights,
         "weights of the network: a file, or the name of those shipped with DySLAM");
  v.choice("start", start,
           {{"standing", DyloStart::standing}, {"prediction", DyloStart::prediction}},
           "initial guess of the motion: zero (standing) or the predicted motion");
  v.integer("threads", threads, 0, 64, "threads of the network; 0: those of pipeline.threads");
  v.flag("prior", prior, "fuse the predicted motion as a prior");
  v.flag("deskew", deskew, "deskew by the estimated motion, not only by the predicted one");
  v.flag("confidence", confidence, "output the static confidence of each point");
  v.real("points_per_measurement", points_per_measurement, 1, 1e6,
         "number of correlated points that count as one measurement");
  v.real("min_inlier_share", min_inlier_share, 0, 1,
         "share of inliers below which the match has failed");
  v.real("max_last_step", max_last_step, 1e-6, 100,
         "length of the last step above which the match has failed [m]");
  v.real("max_translation", max_translation, 0.01, 100,
         "translation between two scans above which the match has failed [m]");
  v.degrees("max_rotation_deg", max_rotation, 0.1, 180,
            "rotation between two scans above which the match has failed [deg]");
}
}  // namespace dyslam
