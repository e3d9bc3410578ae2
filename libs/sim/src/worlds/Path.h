// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dyslam::sim
{
/** A planar path parametrised by arc length [m]. */
class Path
{
 public:
  struct Sample
  {
    Eigen::Vector2d position;
    double heading;  //!< [rad]
  };

  Path() = default;
  /** Polyline through `points` [m]; a closed path connects its end to its start. */
  explicit Path(const std::vector<Eigen::Vector2d>& points, bool closed = false);

  [[nodiscard]] double length() const { return length_; }
  /** Position and heading at arc length `s`, which is clamped to the ends, or wrapped on a closed
   * path. */
  [[nodiscard]] Sample at(double s) const;
  [[nodiscard]] const std::vector<Eigen::Vector2d>& points() const { return points_; }

 private:
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> s_;
  double length_ = 0;
  bool closed_ = false;
};

/** Replaces the corners of a polyline by arcs of about `radius` and resamples every `step` [m]. */
[[nodiscard]] std::vector<Eigen::Vector2d> roundedCorners(
    const std::vector<Eigen::Vector2d>& points, double radius, double step, bool closed);

/** Number of segments of a turn: with few, the turn rate of a vehicle whose wheels follow them
 * would alternate. */
constexpr int kTurnPoints = 64;

/** Cubic Bezier curve from one pose to another, `count` + 1 points. */
[[nodiscard]] std::vector<Eigen::Vector2d> bezier(const Eigen::Vector2d& from,
                                                  double from_heading,
                                                  const Eigen::Vector2d& to,
                                                  double to_heading,
                                                  int count);

/** Angle in (-pi, pi]. */
[[nodiscard]] double wrapToPi(double angle);
}  // namespace dyslam::sim
