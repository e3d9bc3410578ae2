// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/Tracker.h>

#include "PrefixedVisitor.h"

namespace dyslam
{
void ClassTracking::describe(OptionsVisitor& v)
{
  v.real("birth_score", birth_score, -1e6, 1e6, "least score of a detection that starts a track");
  v.real("match_score", match_score, -1e6, 1e6, "least score of a detection that is used");
  v.integer("confirm_hits", confirm_hits, 1, 100, "observations after which a track is confirmed");
  v.real("confirm_score", confirm_score, -1e6, 1e6, "sum of scores that confirms a track as well");
  v.integer("max_misses", max_misses, 0, 1000,
            "misses in a row of a confirmed track before it is deleted");
  v.integer("max_tentative_misses", max_tentative_misses, 0, 1000,
            "misses in a row of a tentative track before it is deleted");
  v.integer("report_misses", report_misses, 0, 1000,
            "misses in a row during which a confirmed track is reported");
  v.real("gate_sigmas", gate_sigmas, 0.1, 100,
         "largest Mahalanobis distance of an associated pair");
  v.real("gate_distance", gate_distance, 0.01, 100, "largest distance of an associated pair [m]");
  v.real("min_sigma", min_sigma, 0.001, 10, "standard deviation added to a predicted position [m]");
  v.real("position_weight", position_weight, 0, 100,
         "weight of (Mahalanobis distance / gate)^2 in the cost");
  v.real("overlap_weight", overlap_weight, 0, 100, "weight of (1 - GIoU) / 2 in the cost");
  v.real("heading_weight", heading_weight, 0, 100,
         "weight of the angle between the axes / 90 deg in the cost");
  v.real("max_cost", max_cost, 0.001, 1000, "largest cost of an associated pair");
  v.real("min_overlap", min_overlap, -1, 1, "least GIoU of an associated pair");
  v.real("score_memory", score_memory, 0, 1,
         "weight of earlier scores in the mean of a track's scores, per observation");
  v.real("score_prior", score_prior, 0, 1000, "zero scores added to the mean of a track's scores");
  v.real("miss_prior", miss_prior, 0, 1000, "zero scores added for each miss");
  v.real("speed_sigma", speed_sigma, 0.01, 100,
         "standard deviation of a new track's speed, for motion = kalman [m/s]");
  v.real("velocity_walk", velocity_walk, 0.01, 100,
         "random walk of the velocity, for motion = kalman, m/s per square root of a second");
}

TrackerOptions::TrackerOptions()
{
  pedestrian.gate_distance = 1.5;
  cyclist.gate_distance = 3;
}

void TrackerOptions::describe(OptionsVisitor& v)
{
  v.choice("motion", motion,
           {{"adaptive", TrackMotion::adaptive},
            {"polynomial", TrackMotion::polynomial},
            {"constant_velocity", TrackMotion::constant_velocity},
            {"kalman", TrackMotion::kalman}},
           "motion model that predicts the next position");
  v.integer("degree", degree, 0, 5, "degree of the fit, for motion = polynomial");
  v.integer("window", window, 1, 1000, "observations in the fit, for motion = polynomial");
  v.choice("association", association,
           {{"shortest_paths", AssociationMethod::shortest_paths},
            {"hungarian", AssociationMethod::hungarian},
            {"greedy", AssociationMethod::greedy}},
           "solver of the assignment problem");
  v.real("dynamic_speed", dynamic_speed, 0, 100,
         "speed above which an object becomes dynamic [m/s]");
  v.real("static_speed", static_speed, 0, 100, "speed below which it becomes static again [m/s]");
  v.real("dynamic_sigmas", dynamic_sigmas, 0, 100,
         "least speed of a dynamic object in standard deviations");
  v.integer("dynamic_hits", dynamic_hits, 1, 100, "scans in a row that must agree on a change");
  v.integer(
      "predicted_scans", predicted_scans, 0, 1000,
      "scans in a row in which a dynamic object is followed by the points in its predicted box "
      "alone; 0: none");
  v.flag("must_move", must_move, "tracks of clusters are confirmed only once they have moved");
  v.flag("complete_boxes", complete_boxes,
         "boxes of clusters are enlarged to the size observed so far");
  v.real("class_mismatch_cost", class_mismatch_cost, 0, 1000,
         "cost added to a pair of different classes; above max_cost it forbids the pair");
  v.real("size_gain", size_gain, 0, 1, "filter gain of an observed size");
  v.degrees("yaw_rate_deg", yaw_rate, 0, 360,
            "standard deviation of a heading's rate of change, deg/s");
  v.flag("adapt_noise", adapt_noise,
         "covariances of boxes from files grow with the noise that is observed");
  PrefixedVisitor vehicles(v, "vehicle_");
  vehicle.describe(vehicles);
  PrefixedVisitor cyclists(v, "cyclist_");
  cyclist.describe(cyclists);
  PrefixedVisitor pedestrians(v, "pedestrian_");
  pedestrian.describe(pedestrians);
}
}  // namespace dyslam
