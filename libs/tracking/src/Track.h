// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/tracking/AdaptivePredictor.h>
#include <dyslam/tracking/KalmanMotion.h>
#include <dyslam/tracking/Tracker.h>

#include <array>
#include <variant>
#include <vector>

#include "ClassOptions.h"

namespace dyslam
{
class StateArchive;

/** A detection transformed to the odometry frame. */
struct Observation
{
  int index = -1;  //!< index in the scan's detections
  Box box;         //!< odometry frame
  Eigen::Matrix4d covariance;
  double noise_factor = 1;  //!< NoiseScale::factor() in the covariance of x and y
  Eigen::Vector2d sensor;   //!< position of the sensor, odometry frame
  ObjectClass object_class = ObjectClass::unknown;
  double score = 0;
  bool from_points = false;  //!< a cluster: box of the visible part only
  bool predicted = false;    //!< Detection::predicted
  bool complete = false;     //!< a cluster that lacks no visible part: of labels with hindsight
};

/** One object's history and state, odometry frame. */
class Track
{
 public:
  Track(int id, double stamp, const Observation& observation, const TrackerOptions& options);
  /** Empty track, to be filled by exchangeState(). */
  explicit Track(const TrackerOptions& options);

  /** Predicts the state at `stamp` [s]; to be called once per scan, before match() or miss(). */
  void predict(double stamp);
  /** Updates the state with the associated observation. */
  void match(const Observation& observation);
  /** Records a scan without an associated observation. */
  void miss();
  /** Saves or loads the state between scans. */
  void exchangeState(StateArchive& archive);

  /** Box of an observation with axes assigned as the track's; clusters are enlarged behind their
   * visible sides to the track's size. */
  [[nodiscard]] Box alignedBox(const Observation& observation) const;

  /** Whether the track has one observation and is not confirmed: its velocity is unknown. */
  [[nodiscard]] bool isNew() const { return hits_ == 1 && !confirmed_; }
  /** Whether the track is not confirmed and a place that it just left is occupied again: static
   * objects in a row that are detected in turn look like a moving one. */
  [[nodiscard]] bool isAliased(const std::vector<Observation>& observations) const;
  /** Largest distance of an associated observation from the predicted position [m]. */
  [[nodiscard]] double gateDistance() const;
  /** Whether points in the box predicted for the next scan may be marked as moving. */
  [[nodiscard]] bool movesByPrediction() const;
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] const Eigen::Matrix2d& positionCovariance() const { return position_covariance_; }
  [[nodiscard]] const ClassTracking& classOptions() const
  {
    return optionsFor(*options_, object_class_);
  }
  [[nodiscard]] ObjectClass objectClass() const { return object_class_; }
  [[nodiscard]] int misses() const { return misses_; }
  /** Positions of the last observations, odometry frame [m]. */
  [[nodiscard]] const std::deque<TimedPosition>& history() const;
  [[nodiscard]] bool dead() const;
  [[nodiscard]] TrackedObject object() const;

 private:
  using Motion = std::variant<AdaptivePredictor, PolynomialTrajectory, KalmanMotion>;
  [[nodiscard]] static Motion makeMotion(const TrackerOptions& options, ObjectClass object_class);
  void addToHistory(const Observation& observation);
  void confirm(const Observation& observation);
  void updatePosition(const Observation& observation, const Box& observed);
  void updateHeading(const Observation& observation, double observed_yaw);
  void alignHeadingWithMotion(const Observation& observation);
  void swapAxes();
  void updateSize(const Observation& observation);
  /** Whether the clusters of the track so far often had the size of a pedestrian: vehicles in part,
   * too, seldom have it. */
  [[nodiscard]] bool isOftenPerson() const;
  void updateDynamicState();
  void keepObservation(const Observation& observation);

  const TrackerOptions* options_;
  int id_;
  double stamp_;
  Motion motion_;
  Box box_;
  Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d velocity_covariance_ = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d position_covariance_ = Eigen::Matrix2d::Identity();
  double vertical_velocity_ = 0;  //!< velocity along z [m/s]
  double z_variance_ = 0.1;
  double yaw_variance_ = 0.1;
  int reversed_observations_ = 0;  //!< excess of observations with the opposite heading
  std::array<double, 8> class_votes_{};
  ObjectClass object_class_ = ObjectClass::unknown;
  double recent_scores_ = 0;  //!< discounted sum of scores
  double score_weight_ = 0;   //!< discounted number of scores
  int hits_ = 1;
  int misses_ = 0;  //!< number of misses in a row
  int total_misses_ = 0;
  int age_ = 0;
  int predicted_hits_ = 0;  //!< observations in a row that were predicted
  bool confirmed_ = false;
  bool dynamic_ = false;
  bool has_moved_ = false;  //!< significant motion was observed at some time
  int change_count_ = 0;    //!< scans in a row whose velocity contradicts `dynamic_`
  int detection_ = -1;
  Box observed_;  //!< alignedBox() of the last observation
  Eigen::Matrix4d observed_covariance_ = Eigen::Matrix4d::Identity();
};
}  // namespace dyslam
