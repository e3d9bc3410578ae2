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
  int index = -1;  //!< among the scan's detections
  Box box;         //!< odometry frame
  Eigen::Matrix4d covariance;
  double noise_factor = 1;  //!< contained in the covariance of x and y
  Eigen::Vector2d sensor;   //!< position of the sensor, odometry frame
  ObjectClass object_class = ObjectClass::unknown;
  double score = 0;
  bool from_points = false;  //!< a cluster: size and heading of the visible part only
  bool predicted = false;    //!< of points that move by prediction alone
};

/** One object's history and state, odometry frame. */
class Track
{
 public:
  Track(int id, double stamp, const Observation& observation, const TrackerOptions& options);
  /** A track that exchangeState() fills. */
  explicit Track(const TrackerOptions& options);

  /** Predicts the state at `stamp` [s]; to be called once per scan, before match() or miss(). */
  void predict(double stamp);
  /** Updates the state with the associated observation. */
  void match(const Observation& observation);
  /** Records a scan without an associated observation. */
  void miss();
  /** What is kept from scan to scan. */
  void exchangeState(StateArchive& archive);

  /** The observation's box as one of this object: axes assigned as the track's, clusters enlarged
   * behind their visible sides to the track's size. */
  [[nodiscard]] Box alignedBox(const Observation& observation) const;

  /** Whether it has one observation and is not confirmed: its velocity is not known. */
  [[nodiscard]] bool isNew() const { return hits_ == 1 && !confirmed_; }
  /** Whether it is not confirmed and a place that it just left is taken again: objects that stand
   * in a row and are seen in turn look like one that moves. */
  [[nodiscard]] bool isAliased(const std::vector<Observation>& observations) const;
  /** Largest distance of an associated observation from the predicted position [m]. */
  [[nodiscard]] double gateDistance() const;
  /** Whether the points in the box predicted for the next scan move, without being segmented. */
  [[nodiscard]] bool movesByPrediction() const;
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] const Eigen::Matrix2d& positionCovariance() const { return position_covariance_; }
  [[nodiscard]] const ClassTracking& classOptions() const
  {
    return optionsFor(*options_, object_class_);
  }
  [[nodiscard]] ObjectClass objectClass() const { return object_class_; }
  [[nodiscard]] int misses() const { return misses_; }
  /** The last observations' positions [m]. */
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
  double vertical_velocity_ = 0;  //!< [m/s]
  double z_variance_ = 0.1;
  double yaw_variance_ = 0.1;
  int reversed_observations_ = 0;  //!< excess of observations with the opposite heading
  std::array<double, 8> class_votes_{};
  ObjectClass object_class_ = ObjectClass::unknown;
  double recent_scores_ = 0;  //!< discounted sum
  double score_weight_ = 0;   //!< discounted count
  int hits_ = 1;
  int misses_ = 0;  //!< in a row
  int total_misses_ = 0;
  int age_ = 0;
  int predicted_hits_ = 0;  //!< observations in a row that were predicted
  bool confirmed_ = false;
  bool dynamic_ = false;
  bool has_moved_ = false;  //!< significant motion was observed at some time
  int change_count_ = 0;    //!< scans in a row whose velocity contradicts `dynamic_`
  int detection_ = -1;
  Box observed_;  //!< the last observation as a box of this object
  Eigen::Matrix4d observed_covariance_ = Eigen::Matrix4d::Identity();
};
}  // namespace dyslam
