// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/tracking/AdaptivePredictor.h>
#include <dyslam/tracking/Tracker.h>

#include <array>
#include <variant>

namespace dyslam
{
/** A detection brought to the odometry frame. */
struct Sighting
{
  int index = -1;  //!< among the scan's detections
  Box box;         //!< odometry frame
  Eigen::Matrix4d covariance;
  Eigen::Vector2d sensor;  //!< where it was seen from, odometry frame
  ObjectClass object_class = ObjectClass::unknown;
  double score = 0;
  bool from_points = false;  //!< a cluster: size and heading are of what was visible
};

/** Options of the kind of object that a class belongs to. */
[[nodiscard]] const ClassTracking& kindOf(const TrackerOptions& options, ObjectClass object_class);

/** One object's history and state, odometry frame. */
class Track
{
 public:
  Track(int id, double stamp, const Sighting& sighting, const TrackerOptions& options);

  /** Where it should be at `stamp`; call once per scan, before match() or miss(). */
  void predict(double stamp);
  void match(const Sighting& sighting);
  void miss();

  /** What was seen, taken as this object: its sides named as the track's are, what is hidden of a
   * cluster added behind the visible sides. */
  [[nodiscard]] Box seenAs(const Sighting& sighting) const;

  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] const Eigen::Matrix2d& positionCovariance() const { return position_covariance_; }
  [[nodiscard]] const ClassTracking& kind() const { return kindOf(*options_, object_class_); }
  [[nodiscard]] ObjectClass objectClass() const { return object_class_; }
  [[nodiscard]] int misses() const { return misses_; }
  [[nodiscard]] bool confirmed() const { return confirmed_; }
  [[nodiscard]] int id() const { return id_; }
  [[nodiscard]] bool dead() const;
  [[nodiscard]] TrackedObject object() const;

 private:
  using Motion = std::variant<AdaptivePredictor, PolynomialTrajectory>;
  [[nodiscard]] static Motion makeMotion(const TrackerOptions& options);
  void remember(const Sighting& sighting);
  void confirm(const Sighting& sighting);
  void moveTo(const Sighting& sighting, const Box& seen);
  void turnTo(const Sighting& sighting, double seen_yaw);
  void turnAlongMotion(const Sighting& sighting);
  void swapAxes();
  void resize(const Sighting& sighting);
  void judgeMotion();
  [[nodiscard]] bool moves() const;

  const TrackerOptions* options_;
  int id_;
  double stamp_;
  Motion motion_;
  Box box_;
  Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d velocity_covariance_ = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d position_covariance_ = Eigen::Matrix2d::Identity();
  double climb_ = 0;  //!< of z [m/s]
  double z_variance_ = 0.1;
  double yaw_variance_ = 0.1;
  int turned_sightings_ = 0;  //!< how many more sightings face backwards than forwards
  std::array<double, 8> class_votes_{};
  ObjectClass object_class_ = ObjectClass::unknown;
  double score_sum_ = 0;
  int hits_ = 1;
  int misses_ = 0;  //!< in a row
  int all_misses_ = 0;
  int age_ = 0;
  bool confirmed_ = false;
  bool dynamic_ = false;
  bool has_moved_ = false;  //!< did at some time, beyond doubt
  int change_votes_ = 0;    //!< scans in a row that speak against `dynamic_`
  int detection_ = -1;
};
}  // namespace dyslam
