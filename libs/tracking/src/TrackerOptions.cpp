// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/Tracker.h>

namespace dyslam
{
namespace
{
/** Describes an options struct inside another: every key gets a prefix. */
class Prefixed : public OptionsVisitor
{
 public:
  Prefixed(OptionsVisitor& visitor, std::string prefix)
      : visitor_(visitor), prefix_(std::move(prefix))
  {
  }
  void real(const char* key, double& value, double min, double max, const char* help) override
  {
    visitor_.real((prefix_ + key).c_str(), value, min, max, help);
  }
  void integer(const char* key, int& value, int min, int max, const char* help) override
  {
    visitor_.integer((prefix_ + key).c_str(), value, min, max, help);
  }
  void flag(const char* key, bool& value, const char* help) override
  {
    visitor_.flag((prefix_ + key).c_str(), value, help);
  }
  void text(const char* key, std::string& value, const char* help) override
  {
    visitor_.text((prefix_ + key).c_str(), value, help);
  }
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char* help) override
  {
    visitor_.word((prefix_ + key).c_str(), value, words, help);
  }

 private:
  OptionsVisitor& visitor_;
  std::string prefix_;
};
}  // namespace

void ClassTracking::describe(OptionsVisitor& v)
{
  v.real("birth_score", birth_score, -1e6, 1e6, "least score of a detection that starts a track");
  v.real("match_score", match_score, -1e6, 1e6, "detections scored below are not used at all");
  v.integer("confirm_hits", confirm_hits, 1, 100, "sightings until a track is reported");
  v.real("confirm_score", confirm_score, -1e6, 1e6, "or the sum of its scores that does as well");
  v.integer("max_misses", max_misses, 0, 1000, "scans without a sighting until a track dies");
  v.integer("max_tentative_misses", max_tentative_misses, 0, 1000,
            "the same before it is confirmed");
  v.integer("report_misses", report_misses, 0, 1000,
            "scans without a sighting that a confirmed track is reported");
  v.real("gate_sigmas", gate_sigmas, 0.1, 100, "farthest sighting from the prediction, in sigmas");
  v.real("gate_distance", gate_distance, 0.01, 100, "and in m");
  v.real("min_sigma", min_sigma, 0.001, 10, "least doubt of a predicted position, m");
  v.real("position_weight", position_weight, 0, 100, "of (distance / gate)^2 in the cost");
  v.real("overlap_weight", overlap_weight, 0, 100, "of (1 - GIoU) / 2 in the cost");
  v.real("heading_weight", heading_weight, 0, 100,
         "of the angle between axes / 90 deg in the cost");
  v.real("max_cost", max_cost, 0.001, 1000, "dearer pairs are not made");
  v.real("min_overlap", min_overlap, -1, 1, "least GIoU of a pair");
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
            {"constant_velocity", TrackMotion::constant_velocity}},
           "how the next position is predicted");
  v.integer("degree", degree, 0, 5, "of motion = polynomial");
  v.integer("window", window, 1, 1000, "sightings fitted by motion = polynomial");
  v.choice("association", association,
           {{"shortest_paths", AssociationMethod::shortest_paths},
            {"hungarian", AssociationMethod::hungarian},
            {"greedy", AssociationMethod::greedy}},
           "solver of the association matrix");
  v.real("dynamic_speed", dynamic_speed, 0, 100, "an object faster is moving, m/s");
  v.real("static_speed", static_speed, 0, 100, "a moving object slower has stopped, m/s");
  v.real("dynamic_sigmas", dynamic_sigmas, 0, 100, "its speed must also be this many sigmas off 0");
  v.integer("dynamic_hits", dynamic_hits, 1, 100, "scans in a row that must agree on a change");
  v.flag("must_move", must_move, "a track of clusters is reported only once it has moved");
  v.flag("complete_boxes", complete_boxes, "boxes of clusters grow to the size seen over time");
  v.real("class_mismatch_cost", class_mismatch_cost, 0, 1000,
         "added to the cost of a pair of different kinds; above max_cost forbids it");
  v.real("size_gain", size_gain, 0, 1, "of one sighting's size");
  v.real("score_prior", score_prior, 0, 1000,
         "a track's score is the mean of its sightings' and this many zeros");
  v.real("miss_prior", miss_prior, 0, 1000, "and this many zeros for every miss");
  v.degrees("yaw_rate_deg", yaw_rate, 0, 360, "how fast headings may turn, deg/s, one sigma");
  Prefixed vehicles(v, "vehicle_");
  vehicle.describe(vehicles);
  Prefixed cyclists(v, "cyclist_");
  cyclist.describe(cyclists);
  Prefixed pedestrians(v, "pedestrian_");
  pedestrian.describe(pedestrians);
}
}  // namespace dyslam
