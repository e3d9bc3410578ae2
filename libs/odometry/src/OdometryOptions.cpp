// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanMatcher.h>

namespace dyslam
{
void OdometryOptions::describe(OptionsVisitor& v)
{
  v.word("method", method, scanMatcherNames(),
         "scan matcher, which estimates the motion between scans");
  v.real("start_speed", start_speed, min_start_speed, max_start_speed,
         "forward speed at the first scan; 0: not known [m/s]");
  v.real("start_speed_sigma", start_speed_sigma, 1e-3, 100,
         "sigma of start_speed, where that is given [m/s]");
}

void FusionOptions::describe(OptionsVisitor& v)
{
  v.real("segmenter_sigma", segmenter_sigma, 1e-4, 10,
         "sigma of the segmenter's ego-motion in x and y [m]");
  v.degrees("segmenter_sigma_rotation_deg", segmenter_sigma_rotation, 1e-3, 90,
            "sigma of the heading of the segmenter's ego-motion [deg]");
  v.renamed("segmenter_sigma_angle_deg", "segmenter_sigma_rotation_deg");
  v.real("matcher_sigma", matcher_sigma, 1e-4, 10,
         "sigma of the translation of a scan matcher's motion [m]");
  v.degrees("matcher_sigma_rotation_deg", matcher_sigma_rotation, 1e-3, 90,
            "sigma of the rotation of a scan matcher's motion [deg]");
  v.renamed("matcher_sigma_angle_deg", "matcher_sigma_rotation_deg");
  v.real("gate", gate, 0.1, 1000,
         "largest Mahalanobis distance to the prior of an accepted motion of segmenter or matcher");
  v.real("informed_sigma", informed_sigma, 1e-4, 10,
         "sigma of the translation of a scan matcher that fuses the prior [m]");
  v.degrees("informed_sigma_rotation_deg", informed_sigma_rotation, 1e-3, 90,
            "sigma of the rotation of a scan matcher that fuses the prior [deg]");
  v.renamed("informed_sigma_angle_deg", "informed_sigma_rotation_deg");
  v.real("informed_gate", informed_gate, 0.1, 1000,
         "largest Mahalanobis distance to the prior of an accepted motion of a matcher that fuses "
         "the prior");
  v.real(
      "segmenter_initial_sigma", segmenter_initial_sigma, 0, 50,
      "sigma of the initial guess at the first registration to a map, if from the segmenter [m]");
  v.real("matcher_initial_sigma", matcher_initial_sigma, 0, 50,
         "sigma of the initial guess at the first registration to a map, if from a matcher that "
         "fuses the prior [m]");
  v.real("reliable_prior_sigma", reliable_prior_sigma, 0, 100,
         "sigma of the prior below which segmenters search only around the prior [m]");
  v.real("min_static_prior", min_static_prior, 0, 1,
         "static probability by appearance below which points have zero weight");
}
}  // namespace dyslam
