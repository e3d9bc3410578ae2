// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/Tracker.h>

#include "ClassOptions.h"

namespace dyslam
{
void ClassTracking::describe(OptionsVisitor& v)
{
  v.real("birth_score", birth_score, -1e6, 1e6, "least score of a detection that starts a track");
  v.real("match_score", match_score, -1e6, 1e6, "least score of a detection that is used");
  v.integer("confirm_hits", confirm_hits, 1, 100,
            "number of observations after which a track is confirmed");
  v.integer("max_misses", max_misses, 0, 1000,
            "misses in a row of a confirmed track after which it is deleted");
  v.integer("max_tentative_misses", max_tentative_misses, 0, 1000,
            "misses in a row of a tentative track after which it is deleted");
  v.integer("report_misses", report_misses, 0, 1000,
            "misses in a row during which a confirmed track is reported");
  v.real("gate_sigmas", gate_sigmas, 0.1, 100,
         "largest Mahalanobis distance of an associated pair of track and detection");
  v.real("gate_distance", gate_distance, 0.01, 100,
         "largest distance of an associated pair of track and detection [m]");
  v.real("max_speed", max_speed, 0, 200,
         "speed up to which a tentative track of one detection is associated also beyond "
         "gate_distance [m/s]");
  v.real("min_sigma", min_sigma, 0.001, 10, "sigma added to a track's predicted position [m]");
  v.real("overlap_weight", overlap_weight, 0, 100,
         "weight of (1 - GIoU) / 2 in the association cost");
  v.real("heading_weight", heading_weight, 0, 100,
         "weight of the angle between the boxes' axes / 90 deg in the association cost");
  v.real("max_cost", max_cost, 0.001, 1000,
         "largest association cost of a pair of track and detection");
  v.real("min_overlap", min_overlap, -1, 1,
         "least GIoU of an associated pair of track and detection");
  v.real("score_memory", score_memory, 0, 1,
         "weight of earlier scores in the mean of a track's scores, per observation");
  v.real("score_prior", score_prior, 0, 1000,
         "number of zero scores added to the mean of a track's scores");
  v.real("miss_prior", miss_prior, 0, 1000,
         "number of zero scores added to the mean of a track's scores for each miss");
  v.real("speed_sigma", speed_sigma, 0.01, 100, "sigma of a new track's speed [m/s]");
  v.real("velocity_walk", velocity_walk, 0.01, 100,
         "random walk of a track's velocity, for motion = kalman [m/s per square root of s]");
}

TrackerOptions::TrackerOptions()
{
  cyclist.gate_distance = 3;
  cyclist.max_speed = 15;
  cyclist.speed_sigma = 5;
  pedestrian.gate_distance = 1.5;
  pedestrian.max_speed = 5;
  pedestrian.speed_sigma = 5;
}

void TrackerOptions::describe(OptionsVisitor& v)
{
  v.choice("motion", motion,
           {{"adaptive", TrackMotion::adaptive},
            {"polynomial", TrackMotion::polynomial},
            {"constant_velocity", TrackMotion::constant_velocity},
            {"kalman", TrackMotion::kalman}},
           "motion model that predicts a track's next position");
  v.integer("degree", degree, 0, 5,
            "degree of the polynomial fitted to a track, for motion = polynomial");
  v.integer("window", window, 1, 1000,
            "number of observations in the fit to a track, for motion = polynomial");
  v.choice("association", association,
           {{"shortest_paths", AssociationMethod::shortest_paths},
            {"greedy", AssociationMethod::greedy}},
           "solver of the assignment problem");
  v.real("dynamic_speed", dynamic_speed, 0, 100,
         "speed above which an object becomes dynamic [m/s]");
  v.real("static_speed", static_speed, 0, 100,
         "speed below which a dynamic object becomes static again [m/s]");
  v.real("dynamic_sigmas", dynamic_sigmas, 0, 100,
         "least speed of a dynamic object, relative to the speed's sigma [sigmas]");
  v.integer("dynamic_hits", dynamic_hits, 1, 100,
            "scans in a row that must agree before an object becomes dynamic or static");
  v.integer("predicted_scans", predicted_scans, 0, 1000,
            "most scans in a row in which a dynamic object is followed by the points in its "
            "predicted box alone; 0: none");
  v.flag("must_move", must_move, "tracks of clusters are confirmed only once they have moved");
  v.flag("complete_boxes", complete_boxes,
         "boxes of clusters are enlarged to the size observed so far");
  v.real(
      "class_mismatch_cost", class_mismatch_cost, 0, 1000,
      "association cost added to a pair of different classes; above max_cost it forbids the pair");
  v.real("size_gain", size_gain, 0, 1, "filter gain of an observed box size");
  v.degrees("yaw_rate_sigma_deg_s", yaw_rate_sigma, 0, 360,
            "sigma of the rate of change of a heading [deg/s]");
  v.renamed("yaw_rate_deg", "yaw_rate_sigma_deg_s");
  v.flag("adapt_noise", adapt_noise,
         "covariances of boxes from files grow with the noise that is observed");
  describeClasses(*this, v);
}
}  // namespace dyslam
