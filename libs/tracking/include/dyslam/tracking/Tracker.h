// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

#include <memory>
#include <vector>

namespace dyslam
{
/** How one kind of object is tracked. Distances in metres, times in scans unless said. */
struct ClassTracking : Options
{
  double birth_score = 0;        //!< a track starts only from detections scored at least this
  double match_score = 0;        //!< detections below are not used at all
  int confirm_hits = 3;          //!< sightings until a track is reported
  double confirm_score = 1e6;    //!< or the sum of its scores that does as well
  int max_misses = 10;           //!< scans without a sighting until it dies
  int max_tentative_misses = 2;  //!< the same before it is confirmed
  int report_misses = 2;         //!< scans without a sighting that a confirmed track is reported
  double gate_sigmas = 4;        //!< how far from the prediction a sighting may be
  double gate_distance = 4;      //!< and at most this far [m]
  double min_sigma = 0.2;        //!< least doubt of a predicted position [m]
  double position_weight = 1;    //!< of (distance / gate)^2 in the cost
  double overlap_weight = 1;     //!< of (1 - GIoU) / 2 in the cost
  double heading_weight = 0.2;   //!< of the angle between the axes, over 90 degrees, in the cost
  double max_cost = 1.2;         //!< pairs that cost more are not made
  double min_overlap = -1;       //!< least GIoU of a pair

  void describe(OptionsVisitor& visitor) override;
};

enum class TrackMotion
{
  adaptive,
  polynomial,
  constant_velocity
};

enum class AssociationMethod
{
  shortest_paths,
  hungarian,
  greedy
};

struct TrackerOptions : Options
{
  TrackMotion motion = TrackMotion::adaptive;
  int degree = 2;   //!< of motion = polynomial
  int window = 30;  //!< sightings, of motion = polynomial
  AssociationMethod association = AssociationMethod::shortest_paths;
  double dynamic_speed = 1.0;        //!< moving above this (V_thres) [m/s]
  double static_speed = 0.5;         //!< and no longer below this [m/s]
  double dynamic_sigmas = 2.5;       //!< the speed must also be this many sigmas from 0
  int dynamic_hits = 3;              //!< scans in a row that must agree
  bool must_move = true;             //!< clusters are reported once they have been moving
  bool complete_boxes = true;        //!< boxes of clusters grow to the size seen over time
  double class_mismatch_cost = 0.5;  //!< added to a pair of different kinds; 10 forbids it
  double size_gain = 0.2;            //!< of a sighting's size
  double score_prior = 3;            //!< sightings scored 0 that every track starts with
  double miss_prior = 1;             //!< how many sightings scored 0 a miss counts as
  double yaw_rate = 0.35;            //!< how fast headings may turn, one sigma [rad/s]
  ClassTracking vehicle;
  ClassTracking cyclist;
  ClassTracking pedestrian;

  TrackerOptions();
  void describe(OptionsVisitor& visitor) override;
};

/** Detections of one scan after another to tracks in the odometry frame.
 *
 * Deterministic; not thread-safe. Detections with NaN or without extent are left out.
 */
class Tracker
{
 public:
  explicit Tracker(const TrackerOptions& options = {});
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /** Reads the frame's detections, stamp and T_odom_vehicle, fills its objects (all living tracks,
   * tentative ones too). */
  void update(Frame& frame);

  /** \param stamp [s], after that of the previous call, else std::invalid_argument
   *  \param detections boxes in the vehicle frame at that time
   *  \return the living tracks, in order of birth. */
  [[nodiscard]] std::vector<TrackedObject> update(double stamp,
                                                  const std::vector<Detection>& detections,
                                                  const Pose& T_odom_vehicle);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};
}  // namespace dyslam
